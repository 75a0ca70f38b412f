"""The observer: age, pupil, accommodation, and where the eyes look."""
