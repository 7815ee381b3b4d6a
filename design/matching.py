"""What a match reaches: every row of a table by name, run as a user does, in a process of its own with a time limit.

    python design/matching.py LS89-parameters 'shared-*' examples          rows by name, by pattern or by group
    python design/matching.py --all --record design/matching.md
    python design/matching.py --list
    python design/matching.py --all --against baseline                     with what another state reached
    python design/matching.py --holdout                                    once, at the end

Deviations are true distances by a search of this script's own: of other, exact points of the shape where it is known,
else of all points of the cloud, from the sides and edges of what `build()` makes. Seconds are of a processor, and of
the call alone. What was reached is kept by the state of the sources (commit, and changes since) in the temporary
directory, so that a row is run once; --again runs it anew.
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import argparse
import fnmatch
import hashlib
import json
import re
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PLACE = Path(tempfile.gettempdir()) / "bladewright-matching"
"""where what was reached is kept"""


def state():
    """The commit of the sources that run, and a hash of what has changed since."""
    import bladewright

    root = Path(bladewright.__file__).parent

    def git(*words):
        return subprocess.run(["git", "-C", str(root), *words], capture_output=True, text=True, check=True).stdout

    changes = git("diff", "HEAD", "--", ".")
    return git("rev-parse", "--short=8", "HEAD").strip() + (
        f"-{hashlib.sha256(changes.encode()).hexdigest()[:6]}" if changes else ""
    )


def held(row, record, records):
    """What was asked and is missed, in words."""
    missed = []
    if row.asked.get("words"):
        if record["status"] == "passed" and row.asked["words"] != "unit":
            missed.append("passed")
        if not re.search(row.asked["words"], record.get("words", "")):
            missed.append(f"words without {row.asked['words']}")
        return missed
    if record["status"] in {"refused", "killed", "broke"}:
        return [record["status"]]
    for name, most in row.asked.items():
        if name == "passed":
            missed += [] if record["status"] == "passed" else ["not passed"]
        elif name == "full rank":
            if record["rank"] < record["parameters"]:
                missed.append(f"rank {record['rank']} of {record['parameters']}")
        elif name == "times":
            other = records.get(most[0], {}).get("seconds")
            if other and record["seconds"] > most[1] * other:
                missed.append(f"{record['seconds'] / other:.1f} times the seconds of {most[0]}")
        else:
            value = value_of(record, name)
            if value is None or value > most:
                missed.append(name if value is None else f"{name} {value:.3g}")
    return missed


def value_of(record, name):
    """A figure of a record: mean and max are in mm, or of the chord."""
    if name in {"mean mm", "max mm"}:
        return 1e3 * record[name.split()[0]]
    if name in {"mean of chord", "max of chord"}:
        return record[name.split()[0]] / record["chord"]
    return record.get(name)


def run(name, limit):
    """A row in this process, ended by the system at the limit of processor time."""
    from matching_rows import ROWS

    row = ROWS[name]
    with tempfile.TemporaryDirectory() as directory:
        cloud = row.cloud(Path(directory))
        spent = time.process_time()
        resource.setrlimit(resource.RLIMIT_CPU, (int(spent + limit) + 2, int(spent + limit) + 4))
        record = row.reach(cloud, row.options, Path(directory))
    print(json.dumps(record))


def recorded(row, limit):
    """The record of a row that is run in a process of its own."""
    command = [sys.executable, __file__, "--run", row.name, "--limit", str(limit)]
    since = time.monotonic()
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, process_group=0) as child:
        try:
            # ten times the limit on the clock, for a machine that is shared
            out, err = child.communicate(timeout=10.0 * limit + 300.0)
        except BaseException as error:
            os.killpg(child.pid, 9)
            if not isinstance(error, subprocess.TimeoutExpired):
                raise
            out, err = child.communicate()
    if child.returncode == 0:
        return {**json.loads(out.splitlines()[-1]), "clock": time.monotonic() - since}
    status = "killed" if child.returncode < 0 else "broke"
    words = f"after {limit:.0f} s" if child.returncode < 0 else (err.strip().splitlines() or [""])[-1]
    return {"status": status, "words": words, "seconds": limit}


def stored(name):
    """What a state reached, by row."""
    path = PLACE / f"{name}.jsonl"
    lines = path.read_text().splitlines() if path.exists() else []
    return {record["row"]: record for record in map(json.loads, lines)}


HEAD = (
    "| row | mean mm | max mm | max of chord | parameters | rank | condition | s | status | asked | missed | words |\n"
    "|---|---|---|---|---|---|---|---|---|---|---|---|"
)


def line(row, record, records, other=None):
    """A line of the table; of another record the figures follow in brackets."""

    def figure(name, form):
        values = [None if each is None else _value(each, name) for each in (record, other)]
        shown = ["" if value is None else form.format(value) for value in values]
        return f"{shown[0]} ({shown[1]})" if other and shown[1] else shown[0]

    cells = [
        row.name,
        figure("mean mm", "{:.4f}"),
        figure("max mm", "{:.4f}"),
        figure("max of chord", "{:.1e}"),
        figure("parameters", "{}"),
        figure("rank", "{}"),
        figure("condition", "{:.0e}"),
        figure("seconds", "{:.0f}"),
        figure("status", "{}"),
        ", ".join(f"{k} {v}" for k, v in row.asked.items()).replace(" True", ""),
        ", ".join(held(row, record, records)) or "-",
        _words(record),
    ]
    return "| " + " | ".join(cell.replace("|", "/") for cell in cells) + " |"


def _value(record, name):
    try:
        return value_of(record, name)
    except KeyError:
        return None


def _words(record):
    said = record.get("words", "")
    if "planted" in record:
        counts = (
            f"{record['kept']} of {record['planted']} outliers kept, {record['dropped']} of {record['good']} dropped"
        )
        said = f"{counts}; {said}" if said else counts
    return said if len(said) < 180 else said[:177] + "..."


def summary(rows, records):
    """For each group, how many rows hold what is asked."""
    lines = ["| group | rows run | all asked is held | killed | refused | s |", "|---|---|---|---|---|---|"]
    for group in dict.fromkeys(row.group for row in rows):
        own = [(row, records[row.name]) for row in rows if row.group == group and row.name in records]
        if own:
            good = sum(not held(row, record, records) for row, record in own)
            count = {kind: sum(record["status"] == kind for _, record in own) for kind in ("killed", "refused")}
            spent = sum(record["seconds"] for _, record in own)
            total = sum(row.group == group for row in rows)
            lines.append(
                f"| {group} | {len(own)} of {total} | {good} | {count['killed']} | {count['refused']} | {spent:.0f} |"
            )
    pooled = [record for record in records.values() if "known" in record]
    if pooled:
        share = {key: sum(record[key] for record in pooled) for key in ("inside", "known", "runs", *COUNTS)}
        lines += [
            "",
            (
                f"Intervals, pooled over {share['runs']} runs: {share['inside'] / share['known']:.3f} of "
                f"{share['known']} true values inside; {share['kept']} of {share['planted']} outliers kept, "
                f"{share['dropped']} of {share['good']} good points dropped."
            ),
        ]
    return "\n".join(lines)


def write_table(path, rows, records):
    """Write the summary and a table for each group after the head of a Markdown file."""
    states = ", ".join(sorted({record["state"] for record in records.values()}))
    parts = [f"Sources {states}, {time.strftime('%Y-%m-%d')}.", summary(rows, records)]
    for group in dict.fromkeys(row.group for row in rows):
        lines = [line(row, records[row.name], records) for row in rows if row.group == group and row.name in records]
        parts += [f"## {group}", "\n".join([HEAD, *lines])] if lines else []
    head = path.read_text().split(MARK)[0].rstrip() if path.exists() else "# What a match reaches"
    path.write_text("\n\n".join([head, MARK, *parts]) + "\n")


MARK = "<!-- what follows is written by matching.py -->"
"""after the head of the table's file"""
COUNTS = ("planted", "kept", "good", "dropped")
"""what is counted of outliers"""


def named(row, names):
    """Whether a row, or its group, is one of some names or patterns."""
    return any(fnmatch.fnmatch(each, name) for each in (row.name, row.group) for name in names)


def main():
    """Run rows, print them, and record them where asked."""
    from matching_rows import HOLD_OUTS, ROWS

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", help="rows, patterns or groups")
    parser.add_argument("--all", action="store_true", help="every row but the hold-outs")
    parser.add_argument("--holdout", action="store_true", help="the hold-outs")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--limit", type=float, help="processor seconds of a row, instead of its own")
    parser.add_argument("--again", action="store_true", help="run rows that this state has reached, too")
    parser.add_argument("--against", help="state whose figures stand in brackets, such as baseline")
    parser.add_argument("--record", type=Path, help="Markdown file for all that this state has reached")
    parser.add_argument("--keep", help="name under which what is reached is kept, instead of the state")
    parser.add_argument("--run", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.run:
        return run(given.run, given.limit)
    chosen = [
        row
        for row in ROWS.values()
        if (given.holdout if row.name in HOLD_OUTS else given.all or named(row, given.names))
    ]
    if given.list:
        print("\n".join(f"{row.name:40} {row.group}" for row in chosen or ROWS.values()))
        return None
    PLACE.mkdir(exist_ok=True)
    name = given.keep or state()
    records, others = stored(name), stored(given.against) if given.against else {}
    print(f"state {name}\n{HEAD}", flush=True)
    for row in chosen:
        if given.again or row.name not in records:
            record = {"row": row.name, "state": state(), **recorded(row, given.limit or row.limit)}
            records[row.name] = record
            with (PLACE / f"{name}.jsonl").open("a") as file:
                file.write(json.dumps(record) + "\n")
        print(line(row, records[row.name], records, others.get(row.name)), flush=True)
    if given.record:
        write_table(given.record, [*ROWS.values()], records)
    return None


if __name__ == "__main__":
    main()
