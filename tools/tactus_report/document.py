"""An HTML page that needs nothing else, its tables and numbers."""

import html
import pathlib
import re

CSS = pathlib.Path(__file__).with_name("page.css")


def html_page(title, body):
    """One page that needs nothing else. `title` is text, `body` a list of elements."""
    return ('<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
            '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
            f"<title>{html.escape(title)}</title>\n"
            f"<style>\n{CSS.read_text(encoding='utf-8')}</style>\n</head>\n<body>\n<main>\n"
            + "\n".join(body) + "\n</main>\n</body>\n</html>\n")


def table(heads, rows, kind):
    """First column names the row."""
    lines = [f'<div class="wide"><table class="{kind}">', "<thead><tr>"]
    lines += [f'<th scope="col">{html.escape(head)}</th>' for head in heads]
    lines.append("</tr></thead>\n<tbody>")
    for first, *rest in rows:
        cells = "".join(f"<td>{with_units(cell)}</td>" for cell in rest)
        lines.append(f'<tr><th scope="row">{html.escape(first)}</th>{cells}</tr>')
    return "\n".join(lines) + "\n</tbody></table></div>"


def with_units(text):
    """Escaped, and no line break between a number and its unit."""
    return re.sub(r"(\d) (N/m|N|mm|m|%)", r"\1&nbsp;\2", html.escape(text))


def with_unit(value, unit):
    return "" if value is None else f"{value:.6g} {unit}"


def number(value, digits, scale=1.0):
    return "" if value is None else f"{scale * value:.{digits}f}"
