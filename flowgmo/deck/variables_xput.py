"""Rows of &xput (time, output, physics, numerics) and &limits. The columns are explained in `row.py`."""

TIME = """
= computed
TWFIN | real | | 1.0 | time | > 0 | M D1-4 S | time at which the run ends
ITWFIN | int | | 2147483647 | - | >= 0 | M D3 | number of steps after which the run ends at the latest
IFIN | int | | 1 | - | 1 2* 3* 4* | M D3 | what ends a run: 1 time, 2 filled part, 3 frozen part, 4 a steady state
DELT | real | | @delt | time | > 0 | M D1 S | first time step; the step of a dry scene
DTMIN | real | | DELT*1e-5 | time | >= 0 | M | a run that needs a smaller step than this one fails
TDTMAX | real | k | 1e10 | time | > 0 | M D1 | largest step during interval k
TEDITDT | real | k | - | time | >= 0 | M D1 | time at which interval k of TDTMAX ends
IEDT | int | | 1 | - | 1 2* 3* | M D3 | what output intervals count: 1 time, 2 filled part, 3 frozen part
TPLTD | real | k | TWFIN/10 | time | > 0 | M D1 D4 | interval of full results and restart data
TAPLTD | real | k | TWFIN/100 | time | > 0 | M D1 D2 | interval of the pictures: bodies and liquid surface
THPLTD | real | k | TWFIN/1000 | time | > 0 | M | interval of history rows
TEDIT | real | k | - | time | >= 0 | M D1 | time at which interval k of the output intervals ends
= computed, needs liquid
AUTOT | real | | 1.0 | - | 0 1 2 | M S | 0 keeps the step, 1 fits it to stability and pressure solution, 2 to stability
CON | real | | 0.45 | - | > 0 | M S | part of a cell that comes in or goes out in a step, to 0.9, with bodies 0.45
CONFS | real | | 1.0 | - | > 0 | M | safety factor of the step limit of surface waves
= accepted
FRCFIN | real | | 1.0 | - | 0..1 | M D3 | part that ends the run with IFIN 2 and 3
ICHKSTDY | int | k | 1 | - | | M | quantities watched for a steady state
DLTSTDY | real | | 1.0 | percent | >= 0 | M | change that still counts as steady
TSTDY | real | | TWFIN*0.1 | time | >= 0 | M | time over which the steady state is judged
CONSFT | real | | @consft | - | > 0 | M | safety factor of the surface tension step
CONHT CONSHR | real | | 0.45 | - | > 0 | M D3 | safety factors of the heat and the shrinkage step
CONES | real | | 0.5 | - | > 0 | M D3 | safety factor of the elastic step
TPRTD | real | k | TWFIN/10 | time | > 0 | M | interval of long prints
TSPRTD | real | k | TWFIN/100 | time | > 0 | M | interval of short prints
ESPRTDT | real | | 600.0 | seconds of wall time | >= 0 | M D3 | interval of short prints by the clock on the wall
PLTFRC PRTFRC | real | | 0.1 | - | > 0 | M D3 | plot and print interval with IEDT 2 and 3
PLTAFRC | real | | 0.01 | - | > 0 | M D3 | interval of selected data with IEDT 2 and 3
LPR | int | | 1 | - | | M S2 | how much is printed
IBENCH | int | | 0 | - | | M | 1 writes the history as text
ITIMER IDBG | int | | 0 | - | | M | timers, debugging prints
IHELP | int | | 1 | - | | M | hints in the printed output
IFIED | int | | 1 | - | | M | 1 writes results at the start
IFCOMP_VF | int | | 1 | - | | M | 1 stores open volumes per component
= known
IFREST | int | | 0 | - | | M D3 | start from the results of another run
= known, with IFREST
DELTR | real | | - | time | > 0 | M D3 | first step after the restart
TREST | real | | 0.0 | time | | M D3 | time of the restart
ITRST | int | | - | - | | M D3 | step of the restart
RESFILE | char | | '' | - | | M D3 | results to start from
= alias
PLTDT | real | | - | time | > 0 | I | old name of TPLTD(1)
HPLTDT | real | | - | time | > 0 | I | old name of THPLTD(1)
PRTDT | real | | - | time | > 0 | I | old name of TPRTD(1)
SPRTDT | real | | - | time | > 0 | I | old name of TSPRTD(1)
"""

PHYSICS = """
= computed
GX GY GZ | real | | 0.0 | length/time2 | | M D1-4 S | acceleration of gravity along {axis}
IMOBS | int | | 0 | - | 0 1 | M | 1 lets bodies move
ICLID | int | | 0 | - | 0 1 | M T | 1 lets bodies collide; needs IMOBS=1
STRNGMOB | real | | 1.0 | - | 0..1 | M T D3 | Stronge's restitution of every body without CRSTRNG and of wall sides
FRCMOB | real | | 0.0 | - | >= 0 | M T D3 | Coulomb friction of every body without CFRC and of wall sides
= computed, needs liquid
ITB | int | | 0 | - | 0 1 | M D1-4 | 1 there is a free surface, 0 all open space is full of liquid
IFVISC | int | | 0 | - | 0 1 | M D1-4 | 1 the liquid is viscous
IWSH | int | | 1 | - | 0 1 | M | 1 viscous liquid sticks to walls and bodies
IPDIS | int | | 0 | - | 0 1 | M D1 D3 | 1 starts with the pressure of liquid at rest; viscous liquids do so without
IMPMOB | int | | 1 | - | 0 1 | M | coupled bodies and liquid: 1 solved together, 0 one after the other, for comparison
= accepted
IMPSFT IMPHTC | int | | 0 | - | | M D2-4 | implicit surface tension, implicit heat conduction
IDPTH | int | | 0 | - | | M D1 | 1 hydraulic output: depths and heads
OFFSET | real | | 0.0 | length | | M D3 | height added to printed elevations
RHOAIR | real | | @rhoair | mass/length3 | > 0 | M D3 | density of air for wind on liquid and lines
IUSRD | int | | 0 | - | | M | data for the user's own routines are read
DUM0 DUM1 DUM2 DUM3 DUM4 DUM5 DUM6 DUM7 DUM8 DUM9 | real | | 0.0 | - | | M | number for the user's own routines
IDUM0 IDUM1 IDUM2 IDUM3 IDUM4 IDUM5 IDUM6 IDUM7 IDUM8 IDUM9 | int | | 0 | - | | M | number for the user's own routines
INTDUM | int | k | 0 | - | | M | numbers for the user's own routines
FPDUM | real | k | 0.0 | - | | M | numbers for the user's own routines
= known
NMAT | int | | 1 | - | 1 2 | M S | number of fluids
ICMPRS | int | | 0 | - | 0 1 | M | 1 the second fluid is compressible
IFVIS | int | | 0 | - | -1 0 1 2 3 4 5 | M D3 | turbulence model; 0 none
IACCF | int | | 0 | - | 0 1 2 | M | the mesh is accelerated: 1 as prescribed, 2 as a rigid body in the flow
IFSFT | int | | 0 | - | | M D2-4 | surface tension
IFENRG | int | | 0 | - | | M D2-4 | energy equation
IHTC | int | | 0 | - | | M D2-4 | heat transfer with solids
IFRHO | int | | 0 | - | 0 1 2 3 | M D2-4 | varying density
IPHCHG | int | | 0 | - | | M D2 | bubbles and change of phase
ICAV | int | | 0 | - | | M | cavitation
IMEMB | int | | 0 | - | | M | elastic membranes and walls
ISWAT | int | | 0 | - | | M | shallow water
ISCOUR | int | | 0 | - | | M | scour and sediment
IFVELP | int | | 0 | - | | M | 1 freezes the flow, 2 leaves it out
"""

NUMERICS = """
= computed, needs liquid
IORDER | int | | 3 | - | 0* 1 2* 3 | M D1 S2 | \
    advection of momentum: 1 first order upwind, 3 second order without new extremes
IFVOF | int | | 6 | - | 0 2* 3 4 5 6 | M D1 D2 D4 | \
    how liquid is moved: 4 donor cell (also 3), 6 surfaces as planes (also 5)
IFPK | int | | 0 | - | 0 1* | M D3 | packing of liquid that numerical errors have thinned
IMPVIS | int | | 0 | - | 0 1 2 3 | M D1 | viscosity: 0 explicit, else implicit
EPSADJ | real | | 1.0 | - | > 0 | M D1-4 | factor of the pressure tolerance
IGMRES | int | | 1 | - | 0 1 2 | M D1 | \
    pressure solver: 0 plain successive over-relaxation, else multigrid with conjugate gradients
= accepted
CFPK | real | | 1.0 | - | >= 0 | M D3 | strength of the packing
IMPADV IMPADV2 | int | | 0 | - | | M D3 | implicit advection
DT_THRESH | real | | 0.0 | time | | M | step below which advection turns implicit
V_THRESH | real | | 1e10 | length/time | | M | speed above which advection turns implicit
DTIMPX | real | | 1e10 | time | | M | largest step of implicit advection
IMP | int | | 1 | - | 0 1 2 | M D1 | pressure coupling; here always implicit
IFDYNCONV | int | | 1 | - | | M | 1 the pressure tolerance follows the flow, as here always
IADIX IADIY IADIZ | int | | 1 | - | 0 1 | M | the pressure is solved along lines in {axis}
OMEGA | real | | @omega | - | > 0 | M D1 | relaxation of the pressure iterations
EPSI | real | | -1.0 | - | | M D1-4 | constant pressure tolerance
IOPT_GMRES | int | | 2 | - | | M | convergence test of the pressure solver
ETA_REL | real | | 0.05 | - | >= 0 | M | relative tolerance of that test
ETA_ABS | real | | 1e-4 | - | >= 0 | M | absolute tolerance of that test
IAUTOSET | int | | 0 | - | | M | subspace size chosen by the solver
ITRNMAX | int | | 7 | - | | M | subspace size at most
EPSVIS | real | | 1.0 | - | > 0 | M | tolerance of implicit viscosity
OMEGVS | real | | - | - | > 0 | M | relaxation of implicit viscosity
IFFS | int | | 0 | - | | M | implicit pressure at the free surface
IBM_PROBE_DIRECTION_METHOD | int | | 0 | - | | M | detail of the immersed boundary
IFLOSS | int | | 0 | - | | M D3 | treatment of slowly growing errors
ALPHAMB | real | | 0.25 | - | | M | pressure exchange between mesh blocks
SSACC SSCOF | real | | 0.0 | - | | M | damping towards a steady state
VOL_CORR_TIME | real | | - | time | | M D3 | time over which a volume error is corrected
IVOL_CORR_TIME | int | | 1 | - | | M D3 | how that time is chosen
= known, needs liquid
ALPHA | real | | 1.0 | - | 0..1 | M S | upwind part of first order advection
FCLEAN FCLEAN2 | real | | 0.0 | - | >= 0 | M D3 | removal of scattered liquid
IF_VOL_CORR | int | | 0 | - | | M D3 | volume errors are corrected
IBM | int | | 0 | - | | M | immersed boundary in place of open fractions
= known, with IFVIS
CNU | real | | 0.09 | - | | M | constant of the turbulence models
CDIS1 | real | | @cdis1 | - | | M | constant of the turbulence models
CDIS2 | real | | 1.92 | - | | M | constant of the turbulence models
CDIS3 | real | | 0.2 | - | | M | constant of the turbulence models
CSPRO | real | | 1.0 | - | | M | constant of the turbulence models
CRHO | real | | 0.0 | - | | M | constant of the turbulence models
RMTKE | real | | @rmtke | - | | M | diffusion of turbulent energy
RMDTKE | real | | @rmdtke | - | | M | diffusion of its dissipation
TLEN | real | | - | length | >= 0 | M | length of the largest eddies; unset, 7 % of the smallest side of the domain
ITLEN | int | | 0 | - | | M | how that length is chosen
"""

LIMITS = """
= computed, needs liquid
EPS | real | | 1e-4 | - | 0..0.5 | M D3 | open fractions nearer than this to 0 or 1 become 0 or 1
VFCLEAN | real | | 0.05 | - | 0..1 | M D3 | lone cells with a smaller open volume are closed
ITMAX | int | | @itmax | - | >= 1 | M D3 | pressure iterations in a step at most; igmres=0: hundreds of sweeps
= accepted
ITMIN | int | | 1 | - | >= 0 | M | pressure iterations in a step at least
ITDTMX | int | | @itdtmx | - | >= 1 | M | pressure iterations that call for a smaller step
ITFLMX | int | | 25 | - | >= 0 | M D3 | failures of the pressure solver in a run at most
NCFLMX | int | | 2 | - | >= 0 | M D3 | failures one after the other at most
MRSTRT | int | | 15 | - | >= 1 | M D3 | subspace size of the pressure solver
ITVSMX | int | | @itvsmx | - | >= 1 | M D3 | iterations of implicit viscosity at most
ILPR IRPR | int | | - | - | | M | {side} end of the printed cells in x
JFPR JBKPR | int | | - | - | | M | {side} end of the printed cells in y
KBPR KTPR | int | | - | - | | M | {side} end of the printed cells in z
XLPR XRPR YFPR YBKPR ZBPR ZTPR | real | | - | length | | M | {side} end of the printed region in {axis}
"""

TABLES = (("XPUT", TIME), ("XPUT", PHYSICS), ("XPUT", NUMERICS), ("LIMITS", LIMITS))
