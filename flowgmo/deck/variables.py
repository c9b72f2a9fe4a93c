"""The registry: every deck variable flowgmo knows, by name, and the blocks they stand in, in a deck's own order."""

from .row import Row, external, rows
from .variables_fluid import TABLES as FLUID
from .variables_obs import TABLES as OBS
from .variables_other import TABLES as OTHER
from .variables_xput import TABLES as XPUT

# In the order in which a deck lists them; &flowgmo, which is ours, comes first after &xput so that it is seen.
BLOCKS = (
    *("XPUT", "FLOWGMO", "LIMITS", "PROPS", "SCALAR", "RBDATA", "BCDATA", "MESH"),
    *("OBS", "FL", "BF", "MOTN", "GRAFIC", "RENDERSPACE", "HEADER", "PARTS"),
)
REQUIRED = ("XPUT", "MESH")
REPEATED = ("BCDATA", "MESH")  # one pair per mesh block
OPEN = ("HEADER",)  # its list of names is not complete and nothing in it changes the answer
# Blocks of the vendor that hold nothing we compute: skipped, and no misspelling of one of ours.
SKIPPED = ("CHM", "USRDAT", "SPRAY", "PCAP", "DETAILS", "WELD", "CASTVAR", "OBSUNUSED")

# Old and misspelt names: what they mean today.
ALIASES: dict[str, tuple[str, tuple[int, ...]]] = {
    **{old: ("IBCT", (side,)) for side, old in enumerate(("WL", "WR", "WF", "WBK", "WB", "WT"), 1)},
    **{f"{old}DT": (f"{new}D", (1,)) for old, new in (("PLT", "TPLT"), ("HPLT", "THPLT"))},
    **{f"{old}DT": (f"{new}D", (1,)) for old, new in (("PRT", "TPRT"), ("SPRT", "TSPRT"))},
}
SPELLINGS = {"FFZTOBMS": "FFZTOBSM"}  # the manual has both
ALSO_IN = {name: ("XPUT",) for name in ("NEVENTS_GMO", "EVENT_ACTION_GMO")}  # printed under &xput, used in &obs


def _registry() -> dict[str, Row]:
    found: dict[str, Row] = {}
    for block, table in (*XPUT, *FLUID, *OBS, *OTHER):
        for row in rows(block, table):
            family = (row, *external(row)) if row.time else (row,)
            for member in family:
                if member.name in found:
                    raise ValueError(f"two rows for {member.name}")
                found[member.name] = member
    return found


REGISTRY: dict[str, Row] = _registry()


def of_block(block: str) -> list[Row]:
    """The rows of one block in the registry's order."""
    return [row for row in REGISTRY.values() if row.block == block]
