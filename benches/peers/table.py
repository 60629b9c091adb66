"""Reads the lines of all runners; writes table.md, table.svg."""

import math
import statistics

import plot

# In the order of the columns. A method that is not listed comes after them.
METHODS = [
    "GSL plain",
    "GSL MISER",
    "GSL VEGAS",
    "vegas 6 5+5",
    "vegas 6 10+10",
    "mchep VEGAS",
    "mchep VEGAS+",
    "scipy qmc_quad",
    "mis uniform random",
    "mis uniform Sobol' 8",
    "mis uniform Sobol' 16",
    "mis own random",
    "mis own Sobol' 8",
    "mis own Sobol' 16",
    "mis own Sobol' 8 power",
]

# Why a peer is ahead of `mis` on an integrand, where one is.
REASONS = {
    "s1": "linear scrambling: in one dimension near exact for most seeds, far off for a few",
}


class Cell:
    """What a method did on an integrand, over all seeds."""

    def __init__(self, reference, runs):
        values, errors, evaluations, seconds = map(list, zip(*runs))
        off = [value - reference for value in values]
        self.runs = len(runs)
        self.evaluations = statistics.mean(evaluations)
        # The fastest but for a tenth: what else the machine did is not the method's.
        self.seconds = sorted(seconds)[len(seconds) // 10]
        self.relative_mse = statistics.fmean(e * e for e in off) / reference**2
        # A result that is exact to the last digits has no more digits to measure.
        self.merit = 1 / (max(self.relative_mse, 2.0**-104) * self.seconds)
        self.rate = self.evaluations / self.seconds
        spread = statistics.stdev(values) if self.runs > 1 else 0
        bias = statistics.fmean(off)
        self.z = bias / (spread / math.sqrt(self.runs)) if spread > 0 else math.nan
        # The same by the errors that the method itself states.
        stated = math.sqrt(statistics.fmean(e * e for e in errors) / self.runs)
        self.error = stated / reference
        self.bias = abs(bias) / reference
        self.stated_z = bias / stated if stated > 0 else math.nan
        self.coverage = statistics.fmean(abs(o) <= 2 * e for o, e in zip(off, errors))


def read(suite, files):
    """The cells by (integrand, method), the methods in order, the versions."""
    references = {entry["name"]: entry["ref"] for entry in suite}
    runs, versions = {}, []
    for file in files:
        for line in file.read_text().splitlines():
            if line.startswith("#"):
                versions.append(line[1:].strip())
                continue
            name, method, _seed, *numbers = line.split(",")
            runs.setdefault((name, method), []).append([float(number) for number in numbers])
    cells = {key: Cell(references[key[0]], of) for key, of in runs.items()}
    methods = list(dict.fromkeys(method for _, method in cells))
    methods.sort(key=lambda m: METHODS.index(m) if m in METHODS else len(METHODS))
    return cells, methods, versions


def grid(suite, methods, title, entry):
    """A table with a row for each integrand and a column for each method."""
    rows = [["integrand", *methods], ["---"] + ["---:"] * len(methods)]
    for integrand in suite:
        name = integrand["name"]
        rows.append([name, *(entry(name, method) for method in methods)])
    return f"## {title}\n\n" + "".join(f"| {' | '.join(row)} |\n" for row in rows)


def scientific(x):
    mantissa, exponent = f"{x:.1e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def ratios(suite, cells, methods):
    """How the best of `mis` compares with the best peer."""
    rows = [["integrand", "best peer", "its merit", "best of mis", "its merit", "ratio", "why"]]
    rows.append(["---", "---", "---:", "---", "---:", "---:", "---"])
    for integrand in suite:
        name = integrand["name"]

        def best(ours):
            merits = [
                (cells[name, m].merit, m)
                for m in methods
                if m.startswith("mis ") == ours and (name, m) in cells
            ]
            return max(merits, default=(math.nan, "-"))

        (theirs, peer), (our, method) = best(False), best(True)
        why = REASONS.get(name, "") if theirs > our else ""
        ratio = scientific(our / theirs)
        rows.append([name, peer, scientific(theirs), method, scientific(our), ratio, why])
    return "## Best of both\n\n" + "".join(f"| {' | '.join(row)} |\n" for row in rows)


def wrong(cells):
    """Methods that are unbiased by their making and yet are not, where their errors are small: an
    integrand must be in error then. A rare sample that few runs met is no such error."""
    return [
        f"{method} on {name}"
        for (name, method), cell in cells.items()
        if method.startswith(("mis ", "GSL plain", "scipy"))
        and cell.error < 0.01 and cell.bias > 1e-4
        and abs(cell.stated_z) > 8
    ]


def write(suite, files, settings, folder):
    """Writes the files into `folder`; returns the text of the table, and what is `wrong`."""
    cells, methods, versions = read(suite, files)

    def entry(formatted):
        return lambda *key: formatted(cells[key]) if key in cells else "-"

    def merit(name, method):
        if (name, method) not in cells:
            return "-"
        cell = cells[name, method]
        best = max(cells[name, m].merit for m in methods if (name, m) in cells)
        text = scientific(cell.merit) + ("!" if cell.coverage < 0.5 else "")
        return f"**{text}**" if cell.merit == best else text

    average = [
        statistics.fmean(cells[e["name"], m].coverage for e in suite if (e["name"], m) in cells)
        for m in methods
    ]
    tables = [
        grid(suite, methods, "Figure of merit", merit),
        ratios(suite, cells, methods),
        grid(suite, methods, "Evaluations", entry(lambda c: f"{c.evaluations:.0f}")),
        grid(suite, methods, "Million evaluations a second", entry(lambda c: f"{c.rate / 1e6:.1f}")),
        grid(suite, methods, "Bias over its standard error", entry(lambda c: f"{c.z:.1f}")),
        grid(suite, methods, "Coverage of 2 sigma", entry(lambda c: f"{c.coverage:.2f}"))
        + f"| all | {' | '.join(f'{mean:.2f}' for mean in average)} |\n",
    ]
    seeds = " to ".join(map(str, sorted({cell.runs for cell in cells.values()})))
    text = f"""<!-- Written by `{settings["command"]}`; do not edit. -->
{seeds} seeds, {settings["evaluations"]} evaluations each, one thread, compiled {settings["target"]}.
{settings["date"]}, {settings["machine"]}.
{"; ".join(settings["versions"] + sorted(versions) + settings["compilers"])}.

Figure of merit: 1 / (relative mean squared error × seconds), the seconds of the
fastest tenth of the runs. A "!" marks
methods whose 2 sigma held in fewer than half of the runs.

""" + "\n".join(tables)
    (folder / "table.md").write_text(text)
    merits = {key: cell.merit for key, cell in cells.items()}
    (folder / "table.svg").write_text(plot.svg([e["name"] for e in suite], methods, merits))
    return text, wrong(cells)
