"""Numbers of brightness that Python and the page share; importing them compiles nothing."""

LUMA = 0.299, 0.587, 0.114  # weights of red, green and blue in the brightness of a colour
DARK_LIFT = 0.5  # fraction of the way to white that black goes on a dark floor; more, and the scale would not only rise
