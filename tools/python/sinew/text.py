"""Texts for a terminal: units of keys, short numbers, tables and paragraphs of 79 columns."""
import textwrap

WIDTH = 79
UNITS = {"N", "Nm", "rad", "m", "s", "Hz", "V", "A", "bar", "kg", "K", "degC", "m2", "m3", "s2", "rad2", "A2", "per",
         "turn", "1"}
# Units that multiply the one before them; all others divide it.
FACTORS = {"Nm": {"s", "s2"}, "N": {"s", "s2"}, "V": {"s"}, "kg": {"m2", "s", "s2"}}


def split_key(key):
    """"viscous_Nm_s_rad" -> ("viscous", "Nm s/rad"): the unit of a key stands behind its name."""
    words = key.split("_")
    first = len(words)
    while first > 1 and words[first - 1] in UNITS:
        first -= 1
    return "_".join(words[:first]), unit_text(words[first:])


def unit_text(units):
    """["Nm", "s", "rad"] -> "Nm s/rad"."""
    if not units:
        return ""
    above, below = units[:1], units[1:]
    if units[0] == "per":
        above = ["1"]
    while below and below[0] in FACTORS.get(units[0], ()):
        above.append(below.pop(0))
    powers = [[unit[:-1] + "^" + unit[-1] if len(unit) > 1 and unit[-1].isdigit() else unit for unit in part]
              for part in (above, below)]
    text = " ".join(powers[0])
    if powers[1]:
        text += "/" + (powers[1][0] if len(powers[1]) == 1 else "(" + " ".join(powers[1]) + ")")
    return text


def number(value):
    """Four digits, of whole numbers seven; "-" for what is not there."""
    if value is None or value != value:
        return "-"
    return f"{value:.0f}" if value == round(value) and abs(value) < 1e7 else f"{value:.4g}"


def quantity(value, unit):
    return f"{number(value)} {unit}".rstrip()


def share(value):
    """0.515 -> "51.5 %"."""
    return "-" if value is None else f"{100 * value:.3g} %"


def table(rows, header=None, indent="  "):
    """Lines with aligned columns: texts to the left, numbers and what is absent to the right."""
    right = [not any(isinstance(row[k], str) for row in rows) for k in range(len(rows[0]) if rows else 0)]
    rows = [[cell if isinstance(cell, str) else number(cell) for cell in row] for row in rows]
    lines = ([list(header)] if header else []) + rows
    out = []
    widths = [max(len(line[k]) for line in lines) for k in range(len(right))]
    for line in lines:
        cells = [cell.rjust(width) if to_right else cell.ljust(width)
                 for cell, width, to_right in zip(line, widths, right)]
        out.append((indent + "  ".join(cells)).rstrip())
    return out


def paragraph(text, indent=""):
    return textwrap.wrap(text, WIDTH, initial_indent=indent, subsequent_indent=indent, break_long_words=False,
                         break_on_hyphens=False)
