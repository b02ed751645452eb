"""Tables in Markdown, for the scripts of the experiments."""

BEGIN, END = "<!-- tables: begin -->", "<!-- tables: end -->"


def number(value):
    """Two digits, without zeros in the exponent; a dash for None."""
    if value is None:
        return "-"
    if value == 0:
        return "0"
    if 0.01 <= abs(value) < 10000:
        return f"{value:.2g}" if abs(value) < 10 else f"{value:.0f}"
    mantissa, exponent = f"{value:.1e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(map(str, row)) + " |" for row in rows]) + "\n"


def put_tables(path, text):
    """Replaces what stands between the two marks of a page; a page without them gets both at its end."""
    page = path.read_text() if path.exists() else ""
    if BEGIN not in page:
        page += f"\n{BEGIN}\n{END}\n"
    before, rest = page.split(BEGIN, 1)
    after = rest.split(END, 1)[1]
    path.write_text(f"{before}{BEGIN}\n{text.strip()}\n{END}{after}")
