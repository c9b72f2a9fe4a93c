"""Rows of the liquid and its surroundings: &props, &scalar, &bcdata, &mesh, &fl, &bf. Columns: see `row.py`."""

PROPS = """
= computed
UNITS | char | | '' | - | | M D1-4 | system of units: 'si', 'cgs', 'eng', 'cust'; here it only labels results
= computed, needs liquid
RHOF | real | | - | mass/length3 | > 0 | M D1-4 S | density of the liquid; a deck without it is dry
MU1 | real | | MUI | mass/length/time | >= 0 | M D1-4 | dynamic viscosity of the liquid
MUI | real | | 0.0 | mass/length/time | >= 0 | M D3 | older name of MU1, used where MU1 is not given
RCSQL | real | | 0.0 | time2 length/mass | >= 0 | M D3 | 1/(density x sound speed squared): compressibility
IPGAUGE | int | | 1 | - | 0 1 | M D2-4 | pressures are 0 absolute, 1 relative to P_REFERENCE
P_REFERENCE | real | | @atmosphere | mass/length/time2 | | M D3 | pressure of the surroundings, one atmosphere
= accepted
FLUID1 FLUID2 | char | | '' | - | | M D1-4 | name of the fluid
TUNITS MUNITS LUNITS TIMUNITS CUNITS | char | | '' | - | | M D1-4 | unit of temperature, mass, length, time, or charge
T_REFERENCE | real | | @freezing | temperature | | M D3 | temperature of reference
MUCTST | real | | 0.0 | - | | M | detail of the viscosity models
MULES | real | | 0.1 | - | | M | constant of the large eddy model
= known, with NMAT
RHOF2 | real | | - | mass/length3 | | M D1-4 | density of the second fluid
MU2 | real | | 0.0 | mass/length/time | >= 0 | M D1-4 | viscosity of the second fluid
RCSQV | real | | 0.0 | time2 length/mass | >= 0 | M D3 | compressibility of the second fluid
= known, with IFSFT
SIGMA | real | | 0.0 | mass/time2 | >= 0 | M D2-4 S1 | surface tension
CSIGMA | real | | 0.0 | mass/time2/temperature | | M D2-4 | its change with temperature
CANGLE | real | | 90.0 | degrees | 0..180 | M D2-4 S1 | contact angle
= known, needs liquid
FRCOF | real | | -1.0 | mass/length2/time | | M D3 | partial slip of walls; not the friction of collisions
= known, with IFENRG
CV1 CV2 | real | | 0.0 | length2/time2/temperature | | M D2-4 | specific heat of fluid 1, 2
THC1 THC2 | real | | -1.0 | - | | M D2-4 | heat conductivity of fluid 1, 2
THEXF1 THEXF2 | real | | 0.0 | 1/temperature | | M D2-4 | thermal expansion of fluid 1, 2
TSTAR | real | | @freezing | temperature | | M D2-4 | temperature at which the densities hold
GAMMA | real | | - | - | | M D2-4 | ratio of the specific heats of a gas
PCAV | real | | - | mass/length/time2 | | M D2-4 | pressure of cavitation
= known
IMU1 | int | | 0 | - | | M D1 | viscosity that depends on shear or temperature
= known, with IMU1
MUC0 MUC1 MUC2 MUC3 MUC4 | real | | 0.0 | - | | M D1 | coefficient of such a viscosity
"""

SCALAR = """
= known
NSC | int | | 0 | - | >= 0 | M D2 | number of substances carried by the liquid
= known, with NSC
SCLTIT | char | k | '' | - | | M D2 | name of a carried substance
ISCLR | int | k | 0 | - | | M D2 | kind of a carried substance
"""

BCDATA = """
= computed
IBCT | int | side | 1 | - | 1 2 3 4 5 6 7* 8 9* 10* 11* | M D1-4 | kind of side: 1 symmetry, 2 wall, 3 continuative, \
4 periodic, 5 pressure, 6 velocity, 7 other mesh, 8 outflow, 9 next block, 10 waves, 11 volume flow
= computed, needs liquid
TIMBCT | real | t | 0.0 | time | | M D3 | times of all tables of &bcdata
UBCT VBCT WBCT | real | t:TIMBCT side | 0.0 | length/time | | M D1 | velocity along {axis} at a side, also of a wall
PBCT | real | t:TIMBCT side | @outside | mass/length/time2 | | M D2-4 | pressure at a side
FBCT | real | t:TIMBCT side | 1.0 | - | 0..1 | M D1-4 | liquid fraction of what enters
IHPBCT | int | side | 0 | - | 0 1 | M | 1 the pressure follows the height FLHTBCT, 0 it is uniform
FLHTBCT | real | t:TIMBCT side | -1e10 | length | | M D3 | height of the liquid outside a side
IPBCTP | int | side | 1 | - | 0 1 | M | pressure given is 1 that of liquid at rest, 0 that of the stream
= known, needs liquid
IPOUTBCT | int | side | 0 | - | | M | pressure side that lets liquid only out
RHOBCT | real | t:TIMBCT side | RHOF | mass/length3 | > 0 | M | density of what enters
IOBCTP | int | side | 0 | - | | M | what happens to backflow at an outflow side
= known, with IBCT
FLRBCT | real | t:TIMBCT side | 0.0 | length3/time | | M | volume that enters in a unit of time
FNX FNY FNZ | real | side | - | - | | M | direction of that inflow
INWAVE | int | side | 3 | - | 1 2 3 4 5 | M | kind of waves
IWAVEBC | int | side | 0 | - | | M | waves of any kind
WAVEAMP | real | side wave | 0.0 | length | | M | amplitude of a wave
WAVEPER | real | side wave | - | time | > 0 | M | period of a wave
WAVELEN | real | side wave | - | length | > 0 | M | length of a wave
WAVEPHS | real | side wave | 0.0 | degrees | | M | phase of a wave
WAVEH | real | side | - | length | | M | undisturbed depth under waves
= known, with IFENRG
IHTBCT | int | side | 0 | - | | D1-3 | heat transfer at a side
TBCT | real | t:TIMBCT side | T_REFERENCE | temperature | | D1-3 | temperature at a side
HWALL1 | real | side | 0.0 | - | | D1-3 | heat transfer coefficient at a side
= alias
WL WR WF WBK WB WT | int | | - | - | 1 2 3 4 5 6 7 8 9 10 11 | I | old name of IBCT for the {side} side in {axis}
"""

MESH = """
= computed
PX PY PZ | real | plane | @plane | length | | M D1-4 | \
    position of a mesh plane along {axis}; first and last bound the domain
NXCELT NYCELT NZCELT | int | | @cells | - | >= 1 | M D1 | number of cells along {axis}
NXCELL NYCELL NZCELL | int | plane | - | - | >= 1 | M | cells along {axis} between this plane and the next one
SIZEX SIZEY SIZEZ | real | plane | - | length | > 0 | M | size of the cells along {axis} at this plane
IF_SIZE | int | | 1 | - | 0 1 | M | directions without a number of cells follow 1 SIZE, 0 NTOTAL
SIZE | real | | 0.0 | length | >= 0 | M D1-4 | size of cells
NTOTAL | int | | 0 | - | >= 0 | M D1-4 | rough number of cells of the whole mesh
IF_MESH_ENABLED | int | | 1 | - | 0 1 | M | 0 leaves this mesh block out
= accepted
MESHNAME | char | | '' | - | | M D1-3 | name of the mesh block
MESH_RANK MESH_TYPE MESH_COMP | int | | 0 | - | | M D2 D3 | order and kind of several mesh blocks
OVERLAP | real | | - | - | | M | overlap of mesh blocks
ICMBOBS | int | m | 1 | - | | M | bodies that a mesh block follows
ISWATLOC | int | | 0 | - | | M | shallow water in this mesh block
= known
ICYL | int | | 0 | - | 0 1 | M S | 1 cylindrical mesh
= known, with ICYL
PYA | real | plane | - | degrees | | M | position of a mesh plane by angle
"""

FL = """
= computed, needs liquid
IFLINITTYP | int | | @liquid | - | 0 1 2 3* | M D1 D2 D4 | \
    liquid at the start: 0 regions only, 1 up to FLHT, 2 the volume VLIN
FLHT | real | | - | length | | M D1 S | height of the liquid at the start
VLIN | real | | 0.0 | length3 | >= 0 | M D3 | volume of the liquid at the start, surface level
PVOID | real | | @outside | mass/length/time2 | | M D2-4 | pressure where there is no liquid
PRESI | real | | PVOID | mass/length/time2 | | M D3 | pressure at the start
UI VI WI | real | | 0.0 | length/time | | M D3 S | velocity of the liquid along {axis} at the start
NFLS | int | | 0 | - | 0..500 | M D2-4 | number of regions of liquid
FXL FXH FYL FYH FZL FZH | real | r | @unbounded | length | | M D2 D4 | {side} bound of a region in {axis}
FRAL FRAH | real | r | @unbounded | length | | M | {side} bound of a region by distance from the z axis
FRSL FRSH | real | r | @unbounded | length | | M | {side} bound of a region by distance from the origin
FANGLL FANGLH | real | r | @unbounded | degrees | | M | {side} bound of a region by azimuth
FCONEL FCONEH | real | r | @unbounded | degrees | | M | {side} bound of a region by angle with the z axis
FIOH | int | r | 1 | - | 0 1 | M | 1 the region adds liquid, 0 it takes it away
IFDIS | int | r | 0 | - | -1 0 1* 2* 3* 4* 5* 6* 7* 8* | M D2 D4 | \
    what a region sets: liquid, 0 by quadric, -1 by STL file
FFSTL | char | r | '' | - | | M | STL file of a region with IFDIS -1
FCC FCX FCY FCZ FCXY FCXZ FCYZ FCX2 FCY2 FCZ2 FCRXY | real | r | 0.0 | - | | M | coefficient of a region's quadric
FREG | real | r | 1.0 | - | 0..1 | M | liquid fraction in a region
PREG | real | r | PRESI | mass/length/time2 | | M | pressure in a region
UREG | real | r | UI | length/time | | M | velocity along x in a region
VREG | real | r | VI | length/time | | M | velocity along y in a region
WREG | real | r | WI | length/time | | M | velocity along z in a region
FROTX FROTY FROTZ | real | r | 0.0 | degrees | | M | turn of a region about {axis}
FTRNX FTRNY FTRNZ | real | r | 0.0 | length | | M | shift of a region along {axis}
FMAGN | real | r | 1.0 | - | > 0 | M | magnification of a region
FMAGNX FMAGNY FMAGNZ | real | r | 1.0 | - | > 0 | M | magnification of a region along {axis}
FXTRFC FYTRFC FZTRFC | real | r | 0.0 | length | | M | centre of a region's turn and magnification, {axis}
IF_FLREG_ENABLED | int | r | 1 | - | 0 1 | M | 0 leaves a region out
= accepted
FLUIDREGIONNAME | char | r | '' | - | | D2 D4 | name of a region
IFLU | int | | - | - | | - | no description found; without effect
UDEEP VDEEP WDEEP | real | | 0.0 | length/time | | M D3 | current along {axis} below the mesh, for mooring lines
= known, needs liquid
RHOREG | real | r | RHOF | mass/length3 | > 0 | M | density in a region
IFVRD | int | k | 0 | - | | M | kind of a pointer into void or liquid
FVRD | real | k | 1.0 | - | | M | liquid fraction that such a pointer sets
XVR YVR ZVR | real | k | - | length | | M | position of such a pointer, {axis}
PVRD | real | t:TIMVRD k | PVOID | mass/length/time2 | | M | pressure that such a pointer sets
TIMVRD | real | t | 0.0 | time | | M | times of the tables of PVRD
= known, with IFVIS
TKEI | real | | - | length2/time2 | | M | turbulent energy at the start
= known, with NSC
RPSI | real | | 0.0 | - | | M D3 | second phase at the start
= known, with IFENRG
TEMPI | real | | T_REFERENCE | temperature | | M D3 | temperature at the start
TVOID | real | | TEMPI | temperature | | M D3 | temperature where there is no liquid
TREG | real | r | TEMPI | temperature | | M D4 | temperature in a region
"""

BF = """
= known
NBAFS | int | | 0 | - | >= 0 | M D3 | number of baffles: walls without thickness
= known, with NBAFS
IBAF | int | r | 0 | - | | M | baffle that a region belongs to
BX BY BZ | real | r | - | length | | M | position of a plane baffle along {axis}
ISTLBF | int | r | 0 | - | | M | form of a baffle region
BXL BXH BYL BYH BZL BZH | real | r | @unbounded | length | | M | {side} bound of a baffle in {axis}
BRAL BRAH | real | r | @unbounded | length | | M | {side} bound of a baffle by distance from the z axis
BIOH | int | r | 1 | - | | M | 1 the region adds to its baffle, 0 it is an opening
PBAF | real | m | 0.0 | - | 0..1 | M | porosity of a baffle
KBAF1 KBAF2 | real | m | 0.0 | - | | M | loss coefficient of a baffle
IFBAF | int | m | 0 | - | | M | 1 the baffle only measures what passes
FPTITL | char | m | '' | - | | M | name of a measuring baffle
IFRCBF | int | | 0 | - | | M | forces on baffles are recorded
BROTX BROTY BROTZ | real | r | 0.0 | degrees | | M | turn of a baffle region about {axis}
BTRNX BTRNY BTRNZ | real | r | 0.0 | length | | M | shift of a baffle region along {axis}
BMAGN | real | r | 1.0 | - | > 0 | M | magnification of a baffle region
BMAGNX BMAGNY BMAGNZ | real | r | 1.0 | - | > 0 | M | magnification of a baffle region along {axis}
"""

TABLES = (("PROPS", PROPS), ("SCALAR", SCALAR), ("BCDATA", BCDATA), ("MESH", MESH), ("FL", FL), ("BF", BF))
