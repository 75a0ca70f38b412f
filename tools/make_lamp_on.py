"""Makes the photographs and the depth of `andon verify relight.lamp_on`.

python tools/make_lamp_on.py                  # some eight minutes on two cores; needs Mitsuba
"""

from andon.verify.lamp_on_room import DATA, make_pictures

if __name__ == "__main__":
    DATA.mkdir(exist_ok=True)
    make_pictures(DATA)
