"""The figures of merit as an SVG: a row for each integrand, a mark for each method."""

import math

ROW, LEFT, WIDTH, TOP = 26, 90, 760, 40
LEGEND = 190
# Peers in colours, shape by family; `mis` in black.
STYLES = {
    "GSL plain": ("#9ecae1", "circle"),
    "GSL MISER": ("#4292c6", "circle"),
    "GSL VEGAS": ("#08519c", "circle"),
    "vegas 6 5+5": ("#98df8a", "square"),
    "vegas 6 10+10": ("#2ca02c", "square"),
    "mchep VEGAS": ("#fdae6b", "triangle"),
    "mchep VEGAS+": ("#d94801", "triangle"),
    "scipy qmc_quad": ("#9467bd", "diamond"),
    "mis uniform random": ("none", "circle"),
    "mis uniform Sobol' 8": ("#777777", "circle"),
    "mis uniform Sobol' 16": ("#000000", "circle"),
    "mis own random": ("none", "diamond"),
    "mis own Sobol' 8": ("#777777", "diamond"),
    "mis own Sobol' 16": ("#000000", "diamond"),
    "mis own Sobol' 8 power": ("#e7298a", "diamond"),
}


def mark(x, y, method):
    colour, shape = STYLES.get(method, ("#888888", "square"))
    stroke = "#000000" if method.startswith("mis ") else colour
    style = f'fill="{colour}" stroke="{stroke}" stroke-width="1.2"'
    if shape == "circle":
        return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" {style}/>'
    corners = {
        "square": [(-4, -4), (4, -4), (4, 4), (-4, 4)],
        "diamond": [(0, -6), (6, 0), (0, 6), (-6, 0)],
        "triangle": [(0, -5), (5, 4), (-5, 4)],
    }[shape]
    points = " ".join(f"{x + dx:.1f},{y + dy:.1f}" for dx, dy in corners)
    return f'<polygon points="{points}" {style}/>'


def text(x, y, words, anchor="start"):
    words = words.replace("&", "&amp;").replace("<", "&lt;")
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{words}</text>'


def svg(names, methods, merits):
    """The picture; `merits` by (name, method)."""
    powers = [math.log10(merit) for merit in merits.values()]
    low, high = math.floor(min(powers)), math.ceil(max(powers))
    step = 1 if high - low <= 20 else 2
    bottom = TOP + ROW * len(names)

    def across(power):
        return LEFT + WIDTH * (power - low) / max(high - low, 1)

    width, height = LEFT + WIDTH + LEGEND, bottom + 50
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
        f'viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="12">',
        f'<rect width="{width}" height="{height}" fill="white"/>',
        text(LEFT, 20, "Figure of merit, 1 / (relative MSE × seconds): further right is better"),
    ]
    for power in range(low, high + 1, step):
        x = across(power)
        parts.append(f'<line x1="{x:.1f}" y1="{TOP}" x2="{x:.1f}" y2="{bottom}" stroke="#dddddd"/>')
        exponent = f'<tspan dy="-5" font-size="9">{power}</tspan>'
        place = f'x="{x:.1f}" y="{bottom + 20}"'
        parts.append(f'<text {place} text-anchor="middle">10{exponent}</text>')
    for row, name in enumerate(names):
        y = TOP + ROW * (row + 0.5)
        parts.append(f'<line x1="{LEFT}" y1="{y}" x2="{LEFT + WIDTH}" y2="{y}" stroke="#eeeeee"/>')
        parts.append(text(LEFT - 8, y + 4, name, "end"))
        for method in methods:
            if (name, method) in merits:
                parts.append(mark(across(math.log10(merits[name, method])), y, method))
    for row, method in enumerate(methods):
        y = TOP + 20 * (row + 0.5)
        parts.append(mark(LEFT + WIDTH + 24, y, method))
        parts.append(text(LEFT + WIDTH + 38, y + 4, method))
    parts.append("</svg>")
    return "\n".join(parts) + "\n"
