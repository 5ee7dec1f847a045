"""Text for LaTeX: what its characters become, and tables in the manner of booktabs."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

SPECIAL: Mapping[str, str] = {
    "\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_",
    "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "×": r"\ensuremath{\times}", "·": r"\ensuremath{\cdot}",
    "≈": r"\ensuremath{\approx}", "≤": r"\ensuremath{\leq}", "≥": r"\ensuremath{\geq}", "±": r"\ensuremath{\pm}",
    "−": r"\ensuremath{-}", "→": r"\ensuremath{\to}", "–": "--", "…": r"\ldots{}", "°": r"\ensuremath{^\circ}",
    "§": r"\S{}", "\N{MULTIPLICATION X}": r"\ensuremath{\times}", "⁺": r"\textsuperscript{+}",
    "²": r"\textsuperscript{2}", "³": r"\textsuperscript{3}",
    **{chr(0x2080 + digit): rf"\textsubscript{{{digit}}}" for digit in range(10)},
}
NUMBER = re.compile(r"([+-]?)(\d+)(?:\.(\d+))?(?:\((\d+)\))?(?:[eE]([+-]?)(\d+))?")  # 5.06(12)e-3


def escaped(text: str) -> str:
    """The text as LaTeX prints it, with any engine."""
    return "".join(SPECIAL.get(character, character) for character in text)


def is_number(field: str) -> bool:
    """Whether siunitx reads the field as a number; an empty one is none, and is left empty."""
    return bool(NUMBER.fullmatch(field))


SMALL = r"  \centering\footnotesize\setlength{\tabcolsep}{3.5pt}"


def booktabs(title: str, columns: Sequence[str], rows: Sequence[Sequence[str]], note: str = "") -> str:
    """A table environment with the rules of booktabs: a column of numbers is siunitx's S, any other is l.

    Text and gaps are small enough for six columns in the width of an article's text. Fields that are empty stand for
    nothing measured. Needs the packages booktabs and siunitx.
    """
    numeric = [all(is_number(row[at]) or not row[at] for row in rows) and any(row[at] for row in rows)
               for at in range(len(columns))]
    form = "".join(f"S[table-format={_format([row[at] for row in rows if row[at]])}]" if number else "l"
                   for at, number in enumerate(numeric))
    heads = " & ".join(f"{{{escaped(name)}}}" for name in columns)
    lines = [" & ".join(field if numeric[at] else escaped(field) for at, field in enumerate(row)) for row in rows]
    return "\n".join([r"\begin{table}", rf"  \caption{{{escaped(title)}}}", SMALL,
                      rf"  \begin{{tabular}}{{{form}}}", r"    \toprule", rf"    {heads} \\", r"    \midrule",
                      *(rf"    {line} \\" for line in lines), r"    \bottomrule", r"  \end{tabular}",
                      *([rf"  \par\smallskip\footnotesize {escaped(note)}"] if note else []), r"\end{table}"]) + "\n"


def _format(fields: Sequence[str]) -> str:
    """siunitx's table-format: a sign, most digits before and after the point, of the uncertainty, of the exponent."""
    parts = [NUMBER.fullmatch(field) for field in fields]
    whole, decimals, uncertain, exponent = (max(len(p[at] or "") for p in parts) for at in (2, 3, 4, 6))
    sign, minus = ("-" if any(p[at] == "-" for p in parts) else "" for at in (1, 5))
    return (f"{sign}{whole}.{decimals}" + (f"({uncertain})" if uncertain else "")
            + (f"e{minus}{exponent}" if exponent else ""))
