"""Palette: the colours of all pictures, whoever draws them: matplotlib, SVG, or the scene's page.

Out: colours as text; for each kind a colour, a darker ink for letters, and a marker.

>>> KIND_COLORS["circle"], KIND_INKS["circle"], KIND_MARKERS["circle"]
('#0072B2', '#00507d', 'o')

Source: Okabe and Ito (2008), "Color Universal Design": colours that colour-blind readers can tell apart. Their yellow
is too faint on white and is left out.
"""

from functools import cache

from .shapes import Kind

# The first four have a contrast of 3 and more to white.
BLUE, VERMILION, GREEN, PURPLE = "#0072B2", "#D55E00", "#009E73", "#CC79A7"
ORANGE, SKY, BLACK = "#E69F00", "#56B4E9", "#000000"
INDIGO = "#332288"  # Paul Tol's: Okabe and Ito have no fifth of that contrast but black
INK, GREY, PALE = "#222222", "#6E6E6E", "#C8C8C8"


def darker(color: str, share: float = 0.7) -> str:
    """Return a colour of which only a share of each of red, green and blue is left.

    >>> darker("#FF8000", 0.5)
    '#804000'
    """
    parts = (int(color[k : k + 2], 16) for k in (1, 3, 5))
    return "#" + "".join(f"{round(share * part):02x}" for part in parts)


def contrast(color: str) -> float:
    """Return a colour's contrast to white, from 1 to 21, as WCAG 2 has it.

    >>> round(contrast("#000000")), round(contrast("#D55E00"), 1)
    (21, 3.9)
    """
    shares = (int(color[k : k + 2], 16) / 255 for k in (1, 3, 5))
    linear = (share / 12.92 if share <= 0.03928 else ((share + 0.055) / 1.055) ** 2.4 for share in shares)
    light = sum(weight * part for weight, part in zip((0.2126, 0.7152, 0.0722), linear, strict=True))
    return 1.05 / (light + 0.05)


@cache
def legible(color: str, least: float) -> str:
    """Return a colour dark enough for this contrast to white; what is pale on purpose, white, or none stays.

    >>> legible("#E69F00", 3.0), legible("#0072B2", 3.0)
    ('#c38700', '#0072B2')
    """
    if not color.startswith("#") or color in (PALE, "#FFFFFF"):
        return color
    share, shown = 1.0, color
    while contrast(shown) < least:
        share -= 0.05
        shown = darker(color, share)
    return shown


KIND_COLORS: dict[Kind, str] = {
    "circle": BLUE,
    "triangle": VERMILION,
    "rectangle": GREEN,
    "pentagon": PURPLE,
    "polygon": INDIGO,
}
KIND_INKS: dict[Kind, str] = {kind: darker(color) for kind, color in KIND_COLORS.items()}  # letters: contrast 4.5
KIND_MARKERS: dict[Kind, str] = {"circle": "o", "triangle": "^", "rectangle": "s", "pentagon": "p", "polygon": "h"}
# A cluster's kind is not known yet: the colours that no kind has come first, and no marker is a kind's. Seven colours
# with six markers: the pairs repeat after 42 clusters.
CLUSTER_COLORS = (ORANGE, SKY, BLACK, PURPLE, VERMILION, BLUE, GREEN)
CLUSTER_MARKERS = ("D", "v", "P", "X", "<", "*")
