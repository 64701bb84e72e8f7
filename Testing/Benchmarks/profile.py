"""Where the time of one case goes, function by function, with Linux's perf.

    profile.py BENCH --data FOLDER [--case NAME] [--write RESULTS.md]

The table goes between the marks "profile" of the file. What the compiler put into its caller counts as
the caller.
"""

import argparse
import datetime
import os
import re
import subprocess
import tempfile

MARKS = ("<!-- profile: begin -->\n", "<!-- profile: end -->")
LEAST = 1.0  # percent of the time


def without_templates(symbol):
    """CGAL's names without what stands in angle brackets."""
    depth = 0
    out = []
    for letter in symbol.replace("operator<", "operator ").replace("->", "- "):
        depth += letter == "<"
        if depth == 0:
            out.append(letter)
        depth -= letter == ">"
    return re.sub(r"\(anonymous namespace\)::", "", "".join(out)).strip()


def record(arguments, path):
    """Runs the case under perf; its stacks tell bulk insertion from refinement."""
    command = ["perf", "record", "-q", "-F", "299", "--call-graph", "dwarf,8192", "-o", path]
    command += [arguments.bench, "--data", arguments.data, "--runs", "1", arguments.case]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


def read_stacks(path):
    """Functions of each sample, the innermost first."""
    command = ["perf", "script", "-i", path, "-F", "ip,sym", "--no-inline"]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    for sample in text.split("\n\n"):
        lines = [line.split(None, 1) for line in sample.splitlines() if line.strip()]
        names = [without_templates(line[1]) for line in lines if len(line) == 2]
        if names and not any(name.startswith("bench_bulk") for name in names):
            yield names


def count(stacks):
    """Samples, and for each function those in itself and those in itself or what it calls."""
    alone = {}
    whole = {}
    total = 0
    for names in stacks:
        total += 1
        alone[names[0]] = alone.get(names[0], 0) + 1
        for name in set(names):
            whole[name] = whole.get(name, 0) + 1
    return total, alone, whole


def table(total, alone, whole):
    """In Markdown, by the time in the function itself."""
    lines = ["| function | itself | with what it calls |", "|---|---:|---:|"]
    for name in sorted(whole, key=lambda name: (-alone.get(name, 0), name)):
        own = 100 * alone.get(name, 0) / total
        if own >= LEAST or (name.startswith("mlim_") and 100 * whole[name] / total >= 5 * LEAST):
            lines.append(f"| {name} | {own:.1f} % | {100 * whole[name] / total:.1f} % |")
    return "\n".join(lines) + "\n"


def replace(path, text):
    """Puts the text between the marks."""
    with open(path, encoding="utf-8") as file:
        before, rest = file.read().split(MARKS[0], 1)
    with open(path, "w", encoding="utf-8") as file:
        file.write(before + MARKS[0] + "\n" + text + "\n" + MARKS[1] + rest.split(MARKS[1], 1)[1])


def main():
    """Records, reads, prints."""
    parser = argparse.ArgumentParser()
    parser.add_argument("bench")
    parser.add_argument("--data", required=True)
    parser.add_argument("--case", default="soft_brain_ants19_prob")
    parser.add_argument("--write")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "perf.data")
        record(arguments, path)
        total, alone, whole = count(read_stacks(path))
    day = datetime.date.today().isoformat()
    text = f"- Date: {day}; {arguments.case}, {total} samples without the bulk insertion\n\n"
    text += table(total, alone, whole)
    print(text)
    if arguments.write:
        replace(arguments.write, text)


if __name__ == "__main__":
    main()
