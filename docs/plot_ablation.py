#!/usr/bin/env python3
"""Draws docs/ablation-motion.svg from the first table of docs/ablation-tables.md."""

import re
from pathlib import Path

HERE = Path(__file__).resolve().parent
WIDTH, HEIGHT, LEFT, TOP = 300, 200, 46, 26
COLOURS = {"bimodal": "#0b6e99", "baseline": "#c4622d"}


def curves():
    """By sequence and preset: bytes of a P-frame and MSDM2 for each motion step."""
    text = (HERE / "ablation-tables.md").read_text().split("## ")[1]
    found = {}
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        points = [re.fullmatch(r"(\d+): ([\d.]+), [\d.]+", cell) for cell in cells[1:]]
        if points and all(points):
            sequence, preset = cells[0].rsplit(", ", 1)
            found.setdefault(sequence, {})[preset] = [(int(p[1]), float(p[2])) for p in points]
    return found


def panel(number, sequence, presets):
    x0, y0 = number % 3 * WIDTH, number // 3 * HEIGHT
    points = [point for curve in presets.values() for point in curve]
    most = 1.05 * max(rate for rate, _ in points)
    low, high = min(d for _, d in points), max(d for _, d in points)
    low, high = low - 0.1 * (high - low), high + 0.1 * (high - low)
    right, bottom = WIDTH - 12, HEIGHT - 30
    place_x = lambda rate: x0 + LEFT + (right - LEFT) * rate / most
    place_y = lambda d: y0 + TOP + (bottom - TOP) * (high - d) / (high - low)
    yield f'<text x="{x0 + LEFT}" y="{y0 + 16}" font-weight="bold">{sequence}</text>'
    yield (f'<path d="M{x0 + LEFT} {y0 + TOP}V{y0 + bottom}H{x0 + right}" fill="none" stroke="#888"/>')
    for d in (low, high):
        yield f'<text x="{x0 + LEFT - 4}" y="{place_y(d) + 4:.1f}" text-anchor="end">{d:.3f}</text>'
    yield f'<text x="{x0 + right}" y="{y0 + bottom + 14}" text-anchor="end">{most:.0f} bytes</text>'
    for preset, curve in presets.items():
        places = [(place_x(rate), place_y(d)) for rate, d in curve]
        line = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
        colour = COLOURS[preset]
        yield f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="2"/>'
        yield from (f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{colour}"/>' for x, y in places)


def main():
    found = curves()
    height = (len(found) + 2) // 3 * HEIGHT + 24
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {3 * WIDTH} {height}" '
        'font-family="sans-serif" font-size="12">',
        f'<rect width="{3 * WIDTH}" height="{height}" fill="white"/>',
    ]
    for number, (sequence, presets) in enumerate(found.items()):
        lines.extend(panel(number, sequence, presets))
    for number, (preset, colour) in enumerate(COLOURS.items()):
        x = LEFT + 130 * number
        lines.append(f'<text x="{x}" y="{height - 8}" fill="{colour}">● {preset}</text>')
    lines.append(
        f'<text x="{LEFT + 270}" y="{height - 8}">MSDM2 of the GoF (less is better) over the bytes of a P-frame</text>'
    )
    (HERE / "ablation-motion.svg").write_text("\n".join(lines + ["</svg>"]) + "\n")


if __name__ == "__main__":
    main()
