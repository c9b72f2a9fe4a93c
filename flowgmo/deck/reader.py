"""From a deck file to a `Deck`, or to a DeckError with everything that is wrong with it."""

import difflib
from pathlib import Path

from .deck import Deck
from .errors import DeckError, Notice, Problem
from .load import load
from .rules import check
from .scan import Block, Scan, assignments, scan
from .store import Filler, Store
from .variables import BLOCKS, REPEATED, REQUIRED, SKIPPED


def read_deck(path: str | Path) -> Deck:
    """Read and check a deck.

    Raises DeckError with all problems of the deck together, never anything else.
    """
    path = Path(path)
    text, notices = load(path)
    deck = parse_deck(text, path)
    deck.notices[:0] = notices
    return deck


def parse_deck(text: str, path: Path) -> Deck:
    """Read and check the text of a deck; `path` names it in messages and is where its files are looked for."""
    found = scan(text, str(path))
    if not found.blocks:
        wrong = "there is no block in the file; is it a deck?"
        raise DeckError([Problem(str(path), None, "", "", wrong, "Write at least &xput and &mesh")])
    mesh_blocks = _known_blocks(found)
    store, filler = Store(), Filler(found)
    meshes = [Store() for _ in range(max(1, *mesh_blocks.values()))]
    first_line: dict[str, int] = {}
    count = dict.fromkeys(REPEATED, 0)
    for block in found.blocks:
        first_line.setdefault(block.name, block.line)
        target = store
        if block.name in REPEATED:
            target = meshes[count[block.name]]
            count[block.name] += 1
        filler.take(block, target, assignments(block, found))
    filler.finish()
    deck = Deck(path, found.title, store, first_line)
    deck.mesh_lines = _choose_mesh(found, store, meshes)
    problems, notices = check(deck)
    # The scanner works block by block: put everything in the order of the lines, the rules' findings too.
    found.problems += problems
    found.notices += notices
    found.problems.sort(key=lambda problem: problem.line or 0)
    found.notices.sort(key=lambda notice: notice.line or 0)
    if found.problems:
        raise DeckError(dict.fromkeys(found.problems), dict.fromkeys(found.notices))
    deck.notices = list(dict.fromkeys(found.notices))
    return deck


def _known_blocks(found: Scan) -> dict[str, int]:
    """Drop unknown blocks, report missing and double ones; returns how often each repeated block stands."""
    missing = set(REQUIRED) - {block.name for block in found.blocks} - {problem.block for problem in found.problems}
    kept: dict[str, Block] = {}
    blocks: list[Block] = []
    for block in found.blocks:
        name = block.name.lower()
        if block.name not in BLOCKS:
            near = difflib.get_close_matches(block.name, BLOCKS, 1, 0.66)  # one wrong letter of three
            if near and block.name not in SKIPPED:
                missing.discard(near[0])
                write = f"Write &{near[0].lower()}"
                found.problem(block.line, "", f"&{name} is no block of a deck", write)
            else:
                text = f"the block &{name} is not used here and is skipped"
                found.notices.append(Notice(found.file, block.line, "", "", text))
            continue
        if block.name in kept and block.name not in REPEATED:
            wrong = f"the block stands twice, in line {kept[block.name].line} and in line {block.line}"
            found.problem(block.line, block.name, wrong, "Put both together into one")
        kept.setdefault(block.name, block)
        blocks.append(block)
    for name in sorted(missing):
        example = "px(1)=0., px(2)=1., and so on" if name == "MESH" else "twfin=1.0"
        found.problem(None, "", f"there is no block &{name.lower()}", f"Add &{name.lower()} {example} /")
    found.blocks = blocks
    return {name: sum(block.name == name for block in blocks) for name in REPEATED}


def _choose_mesh(found: Scan, store: Store, meshes: list[Store]) -> list[int]:
    """Put the first mesh block that is switched on, with its boundaries, into the deck's values.

    Returns the lines of all mesh blocks that are switched on; flowgmo computes one of them.
    """
    lines = [block.line for block in found.blocks if block.name == "MESH"]
    sides = [block.line for block in found.blocks if block.name == "BCDATA"]
    if len(sides) > max(1, len(lines)):
        wrong = f"there are {len(sides)} &bcdata and {len(lines)} &mesh"
        found.problem(sides[len(lines)], "BCDATA", wrong, "Give each mesh block one &bcdata, before its &mesh")
    enabled = [k for k in range(len(lines)) if meshes[k].values.get("IF_MESH_ENABLED", {}).get((), 1)]
    if lines and not enabled:
        found.problem(lines[0], "MESH", "no mesh block is switched on", "Write if_mesh_enabled=1", "if_mesh_enabled")
    chosen = meshes[enabled[0] if enabled else 0]
    store.values |= chosen.values
    store.lines |= chosen.lines
    for mesh in meshes:
        store.broken |= mesh.broken
    return [lines[k] for k in enabled]
