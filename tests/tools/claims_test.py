#!/usr/bin/env python3
"""docs/claims.md: every figure stands in the section of the page that its row names, and every row says
what measures it. The check itself must be able to fail."""
import pathlib
import re
import unittest

DOCS = pathlib.Path(__file__).resolve().parents[2] / "docs"
NUMBER = re.compile(r"(?<![\w.])\d+(?: \d{3})+|\d[\d.]*(?:e-?\d+|/\d+)?")


def section(link):
    """Of a page, from the heading that the link's anchor names to the next of its level."""
    name, anchor = link.split("#")
    lines = (DOCS / name).read_text().splitlines()
    begin = next(i for i, line in enumerate(lines) if line.startswith("#") and
                 re.sub(r"[^\w\- ]", "", line.lstrip("# ").lower()).replace(" ", "-") == anchor)
    level = lines[begin].split()[0]
    end = next((i for i in range(begin + 1, len(lines))
                if re.match(rf"#{{1,{len(level)}}} ", lines[i])), len(lines))
    return "\n".join(lines[begin:end])


def numbers(text):
    return {number.rstrip(".") for number in NUMBER.findall(text)}


def problems(page):
    rows = re.findall(r"^\| (?!Claim )(.*) \|$", page, re.M)
    found = []
    for row in rows:
        claim, figure, measured, link = row.split(" | ")
        if not re.search(r"`(tactus |tools/|[A-Z]\w+`|python\.|hil\.)", measured):
            found.append(f"not measured: {claim}")
        there = numbers(section(re.search(r"\]\((.*)\)", link).group(1)))
        found += [f"{number} is not in {link}: {claim}"
                  for number in sorted(numbers(figure) - there)]
    return found if rows else ["no rows"]


class ClaimsTest(unittest.TestCase):
    page = (DOCS / "claims.md").read_text()

    def test_every_figure_stands_in_its_page(self):
        self.assertEqual(problems(self.page), [])

    def test_another_figure_is_refused(self):
        page = self.page.replace("12.81 N", "12.82 N")
        self.assertEqual([p.split()[0] for p in problems(page)], ["12.82"])

    def test_a_claim_that_nothing_measures_is_refused(self):
        page = self.page.replace("`tactus bench --clutter`", "experience")
        self.assertEqual(len(problems(page)), 1)


if __name__ == "__main__":
    unittest.main()
