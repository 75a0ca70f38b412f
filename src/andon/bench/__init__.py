"""Speed, beside peers, in one run: ``andon bench``.

No time is printed before both sides have been asserted to give the same answer. Times are medians
of repetitions that alternate between the two sides, so that a machine that slows down slows both.
"""
