#!/usr/bin/env python3
"""Holds every #include and every CMake dependency to the table of rooms in ARCHITECTURE.md.

A room may include itself, the rooms of its row, and what those may include. A heavy library's headers
may be included by the rooms whose row owns their prefix, and by no other.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


def read_table(path):
    """room -> (rooms of its row, prefixes of the library headers that it owns)."""
    rooms = {}
    for line in path.read_text().splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if not line.startswith("| `") or len(cells) != 5:
            continue
        names = [re.findall(r"`([^`]+)`", cell) for cell in cells]
        rooms[names[0][0]] = (names[2], names[4])
    return rooms


def closure(rooms, room):
    """The room and all that it may include, directly or through others."""
    seen = set()
    ahead = [room]
    while ahead:
        name = ahead.pop()
        if name not in seen:
            seen.add(name)
            ahead.extend(rooms[name][0])
    return seen


def check_includes(rooms, room, path, faults):
    allowed = closure(rooms, room)
    own = rooms[room][1]
    foreign = {p: r for r, row in rooms.items() for p in row[1] if p not in own}
    for number, line in enumerate(path.read_text().splitlines(), 1):
        where = f"{path.relative_to(ROOT)}:{number}"
        match = re.match(r'\s*#\s*include\s*[<"]([^>"]+)[>"]', line)
        if not match:
            continue
        included = match.group(1)
        if included.startswith("calibrato/"):
            other = included.split("/")[1]
            if other not in allowed:
                faults.append(f"{where}: {room} may not include {other}")
            continue
        for prefix, owner in foreign.items():
            if included.startswith(prefix):
                faults.append(f"{where}: <{prefix}> is private to {owner}")


def check_cmake(rooms, room, path, faults):
    match = re.search(r"DEPENDS\s+([a-z_\s]+?)(?:HEAVY|\))", path.read_text())
    for other in match.group(1).split() if match else []:
        if other not in closure(rooms, room):
            faults.append(f"{path.relative_to(ROOT)}: {room} may not depend on {other}")


def main():
    rooms = read_table(ROOT / "ARCHITECTURE.md")
    faults = []
    for folder in sorted((ROOT / "calibrato").iterdir()):
        if folder.name not in rooms:
            faults.append(f"calibrato/{folder.name}: not in the table of ARCHITECTURE.md")
            continue
        for path in sorted(folder.rglob("*")):
            if path.suffix in (".h", ".cc"):
                check_includes(rooms, folder.name, path, faults)
            elif path.name == "CMakeLists.txt":
                check_cmake(rooms, folder.name, path, faults)
    for room in rooms:
        if not (ROOT / "calibrato" / room).is_dir():
            faults.append(f"ARCHITECTURE.md: room {room} has no folder")
    for fault in faults:
        print(f"error: layering, {fault}", file=sys.stderr)
    print(f"layering: {len(rooms)} rooms, {len(faults)} faults")
    return 1 if faults or not rooms else 0


if __name__ == "__main__":
    sys.exit(main())
