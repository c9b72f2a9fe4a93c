"""Rows of the remaining blocks, among them &flowgmo, which is ours. The columns are explained in `row.py`."""

RBDATA = """
= known, with IACCF
RBMASS RBJXX RBJYY RBJZZ | real | | 1.0 | - | | M | mass or moment of inertia of the accelerated tank
RBJXY RBJXZ RBJYZ | real | | 0.0 | mass length2 | | M | product of inertia of the tank
RCXP RCYP RCZP | real | | 0.0 | length | | M | {axis} of the tank's mass centre
UCXP UCYP UCZP | real | | 0.0 | length/time | | M | velocity of the tank along {axis} at the start
OMXI OMYI OMZI | real | | 0.0 | radians/time | | M | turn of the tank about {axis} at the start
IRBACC | int | | 0 | - | | M | what is prescribed of the tank's motion
NCRBMX | int | | 100 | - | | M | iterations between tank and liquid at most
OMDIMP | real | | 0.501 | - | | M | weight of the new values
EPSIRB | real | | - | - | | M | tolerance of these iterations
"""

MOTN = """
= known, with IACCF
IATYPE | int | | 0 | - | 0 1 2 3 4 5 6 | M | kind of prescribed acceleration of the mesh
RCX RCY RCZ | real | | 0.0 | length | | M | {axis} of the centre of its turn
GRAVX GRAVY GRAVZ | real | | 0.0 | length/time2 | | M | gravity along {axis} of the fixed axes
A0 | real | | 0.0 | length/time2 | | M | amplitude of a shake
OMG0 | real | | 0.0 | radians/time | | M | frequency of a shake
RPS SPIN | real | | 0.0 | 1/time | | M | rate of a spin
TMAGX TMAGY TMAGZ | real | | 0.0 | length | | M | amplitude of a sinusoidal shift along {axis}
TFREQX TFREQY TFREQZ | real | | 0.0 | 1/time | | M | frequency of a sinusoidal shift along {axis}
TPHIX TPHIY TPHIZ | real | | 0.0 | degrees | | M | phase of a sinusoidal shift along {axis}
RMAGX RMAGY RMAGZ | real | | 0.0 | degrees | | M | amplitude of a sinusoidal turn about {axis}
RFREQX RFREQY RFREQZ | real | | 0.0 | 1/time | | M | frequency of a sinusoidal turn about {axis}
RPHIX RPHIY RPHIZ | real | | 0.0 | degrees | | M | phase of a sinusoidal turn about {axis}
FMOVIN | char | | 'movin.inp' | - | | M | file with a table of the motion
ACONV OMCONV | real | | 1.0 | - | | M | factor of the columns of that file
"""

GRAFIC = """
= computed, needs liquid
XLOC YLOC ZLOC | real | k | - | length | | M D1-4 | {axis} of probe k
IF_PROBE_ENABLED | int | k | 1 | - | 0 1 | M | 0 leaves a probe out
NPMOV | int | k | 0 | - | 0 1* | M | 1 lets a probe drift with the liquid
= accepted
ANMTYP | char | k | '' | - | | M D1-4 | quantity in the selected data
WINTL | char | k | '' | - | | M | name of a probe
= known
LOCOBS | int | k | 0 | - | 0..500 | M | component that carries a probe; 0 fixed in space
= known, with LOCOBS
LOCOPT | int | k | 0 | - | 0 1 | M | a carried probe 0 moves and turns, 1 only moves
"""

PARTS = """
= known
NPXYZ | int | | 0 | - | >= 0 | M D4 | number of blocks of marker particles
= known, with NPXYZ
NPX NPY NPZ | int | k | 0 | - | | M D4 | particles of a block along {axis}
XPL XPR YPF YPBK ZPB ZPT | real | k | - | length | | M D4 | {side} end of a block of particles in {axis}
UPI VPI WPI | real | k | 0.0 | length/time | | M | velocity of particles along {axis} at the start
"""

HEADER = """
= accepted
PROJECT | char | | '' | - | | M D1-4 | name of the project
VERSION | char | | 'double' | - | | M D1-4 | precision of the vendor's solver
NPROCS | int | | 0 | - | | M | number of processors
RUN_WITH_AVAILABLE | int | | 0 | - | | M | starts with fewer processors
"""

RENDERSPACE = """
= accepted
RSXMIN RSXMAX RSYMIN RSYMAX RSZMIN RSZMAX | real | | - | length | | M D3 | {side} end of the drawn region in {axis}
RSCSIZE | real | | - | length | | M D3 | cell size of drawn solids
IFRS | int | | 0 | - | | M D3 | 1 draws solids on their own mesh
QVAL_FAVOR | real | | 0.5 | - | | M D3 | open fraction at which solids are drawn
"""

FLOWGMO = """
= computed
IMPACT | char | | 'exact' | - | 'exact' 'euler' | - | \
    one impact: solved exactly, or with fixed steps of the impulse as in the report
DPFRAC | real | | 0.01 | - | > 0 | - | step of 'euler' as a part of the estimated impulse
SEARCH | char | | 'surface' | - | 'surface' 'grid' | - | \
    contacts found on the true surfaces, or at mesh nodes as in the report
MULTIPLE | char | | 'simultaneous' | - | 'simultaneous' 'sequential' | - | \
    touching contacts resolved together or in turn
HERTZ | real | | 1.5 | - | > 0 | - | exponent of the contact law that shares an impact: 1 linear, 1.5 Hertz
TOUCH | real | | 1e-9 | radii of the smaller body | >= 0 | - | gap that counts as touching
RESTING | char | | 'constraint' | - | 'constraint' 'micro' | - | \
    lasting contact: a constraint, or many small collisions
SLEEP | logical | | .true. | - | | - | bodies at rest cost nothing
AXISX AXISY AXISZ | real | m | @axis | - | | - | {axis} of the direction of the fixed axis of a body with IMOAXS=1
RESTART_DT | real | | 600.0 | seconds of wall time | > 0 | - | interval of restart files
IGNORE_UNSUPPORTED | logical | | .false. | - | | - | runs although the deck asks for effects that are not computed
= computed, needs liquid
WETIMPACT | char | | 'wet' | - | 'wet' 'dry' | - | impacts in liquid: with the liquid's inertia or without
LUBRICATION | logical | | .true. | - | | - | force of the film in narrow gaps; acts with viscosity
FILMROUGH | real | | - | length | > 0 | - | roughness at which that force ends to grow; else 1e-4 of the smaller body
PLANEX PLANEY PLANEZ | real | k | - | length | | - | plane of constant {axis} whose flow is recorded
PLANEXL PLANEXH PLANEYL PLANEYH PLANEZL PLANEZH | real | k | @unbounded | length | | - | \
    {side} bound of such a plane in {axis}
"""

TABLES = (
    ("RBDATA", RBDATA),
    ("MOTN", MOTN),
    ("GRAFIC", GRAFIC),
    ("RENDERSPACE", RENDERSPACE),
    ("HEADER", HEADER),
    ("PARTS", PARTS),
    ("FLOWGMO", FLOWGMO),
)
