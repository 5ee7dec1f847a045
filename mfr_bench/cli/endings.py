"""The exit statuses that commands choose themselves; `errors` has those of mistakes and interruptions."""

OUT_OF_TIME = 1  # the time ended before anything could be told
WRONG = 3  # an image is wrong, a promise is broken, or a bundle is odd
REGRESSION = 4  # something is slower, or newly wrong
DOUBT = 5  # nothing could be told, or cells are missing
NOTHING_KEEPS = 6  # no method keeps the bounds
