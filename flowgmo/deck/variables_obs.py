"""Rows of &obs: components, their geometry, motion, mass, forces, springs, collisions. Columns: see `row.py`."""

GEOMETRY = """
= computed
NOBS | int | | 0 | - | 0..500 | M D3 D4 S2 | number of components, moving and fixed
OBSID | char | m | '' | - | | M D3 | name of a component: letters, digits and _ . -
IFCOMPENABLED | int | m | 1 | - | 0 1 | M | 0 leaves a component out
IFSUBCOMPENABLED | int | n | 1 | - | 0 1 | M | 0 leaves a subcomponent out
IOB | int | n | 0 | - | 0..500 | M D3 | component that subcomponent n belongs to
IOH | int | n | 1 | - | -1 0 1 | M D3 S2 | 1 adds solid, 0 cuts a hole, -1 adds everything outside the shape
IGEN | int | n | 0 | - | 0 3 5* | M D3 | form of a subcomponent: 0 quadric with limits, 3 STL file
FSTL | char | n | @stl | - | | M | STL file of subcomponent n
XL XH YL YH ZL ZH | real | n | @unbounded | length | | M D3 I | {side} bound of a subcomponent in {axis}
RAL RAH | real | n | @unbounded | length | | M | {side} bound by distance from the z axis
RSL RSH | real | n | @unbounded | length | | M | {side} bound by distance from the origin
ANGLL ANGLH | real | n | @unbounded | degrees | | M | {side} bound by azimuth
CONEL CONEH | real | n | @unbounded | degrees | | M | {side} bound by angle with the z axis
RTORIN RTOROUT | real | n | -1.0 | length | | M D3 | {side} radius of a torus about the z axis; below 0 none
CC | real | n | -0.1 | - | | M D3 | constant of the quadric; the solid is where the quadric is <= 0
CX CY CZ | real | n | 0.0 | - | | M D3 | coefficient of {axis} in the quadric
CXY | real | n | 0.0 | - | | M D3 | coefficient of xy in the quadric
CXZ | real | n | 0.0 | - | | M D3 | coefficient of xz in the quadric
CYZ | real | n | 0.0 | - | | M D3 | coefficient of yz in the quadric
CX2 CY2 CZ2 | real | n | 0.0 | - | | M D3 | coefficient of {axis} squared in the quadric
CRXY | real | n | 0.0 | - | | M D3 | coefficient of the distance from the z axis in the quadric
MAGN | real | n | 1.0 | - | > 0 | M D3 | magnification of a subcomponent, in all directions
MAGNX MAGNY MAGNZ | real | n | 1.0 | - | > 0 | M D3 | magnification of a subcomponent along {axis}
ROTX ROTY ROTZ | real | n | 0.0 | degrees | | M D3 | turn of a subcomponent about {axis}, after its magnification
TRNX TRNY TRNZ | real | n | 0.0 | length | | M D3 | shift of a subcomponent along {axis}, after its turn
XTRFC YTRFC ZTRFC | real | n | 0.0 | length | | M D3 | {axis} of the centre of magnification and turn
GMAGN | real | m | 1.0 | - | > 0 | M D3 | magnification of a component, after its subcomponents' own
GMAGNX GMAGNY GMAGNZ | real | m | 1.0 | - | > 0 | M D3 | magnification of a component along {axis}
GROTX GROTY GROTZ | real | m | 0.0 | degrees | | M D3 | turn of a component about {axis}
GTRNX GTRNY GTRNZ | real | m | 0.0 | length | | M D3 | shift of a component along {axis}
GXTRFC GYTRFC GZTRFC | real | m | 0.0 | length | | M D3 | {axis} of the centre of a component's turn
IGTRFMVB | int | m | 0 | - | 0 1 | M | 1 the component's transform also moves its body axes and mass data
= computed, needs liquid
IFRCO | int | m | 0 | - | 0 1 | M | 1 records the load on a fixed component
XFRCO YFRCO ZFRCO | real | m | 0.0 | length | | M D3 | {axis} of the point that recorded torques refer to
IFWETAR | int | m | 0 | - | 0 1 | M | 1 records the wetted area of a fixed component; that of moving ones always is
IBUOYO | int | m | 0 | - | 0 1 | M | metacentric height; the centre of buoyancy of moving bodies is always recorded
IPREF | int | m | 1 | - | 1 2 | M | reference pressure: 1 PREFMBW, 2 mean over the wet surface
PREFMBW | real | m | PVOID | mass/length/time2 | | M | pressure on dry and on outlying surface
IAVRCK | int | | 0 | - | 0 1 | M | 1 raises the open volume of slivers, which moves walls
AVRCK | real | | 3.1 | - | | M D1 | ratio of open area to volume that makes a sliver
= accepted
SUBCMPID | char | n | '' | - | | M D3 | name of a subcomponent
MATERIAL | char | m | '' | - | | M D3 | name of a material
= known
ICPY | int | n | 0 | - | >= 0 | M | component that is a copy of another one
IVRT | int | m | 0 | - | >= 0 | M | kind of copy
IFOB | int | m | 0 | - | | M D3 | special component: porous, fan, sampling volume, absorber ...
IFSPIN | int | m | 0 | - | | M | body of revolution that spins in place
= known, with ICPY
CMAGN CMAGNX CMAGNY CMAGNZ | real | n | 1.0 | - | | M | magnification of a copy
CROTX CROTY CROTZ | real | n | 0.0 | degrees | | M | turn of a copy about {axis}
CTRNX CTRNY CTRNZ | real | n | 0.0 | length | | M | shift of a copy along {axis}
CRFLX CRFLY CRFLZ | real | n | 0.0 | - | | M | mirror image of a copy across {axis}
= known, needs liquid
ROUGH | real | m | 0.0 | length | | M D3 | roughness of a component; below 0 it is slippery
ROUGHSUB | real | n | ROUGH(m) | length | | M D3 | roughness of a subcomponent
OFRCOF | real | m | -1.0 | mass/length2/time | | M | partial slip on a component
= known, with IFSFT
OCANG | real | m | CANGLE | degrees | | M | contact angle on a component
= known, with IFSPIN
OSPIN | real | t:TOBS m | 0.0 | angle/time | | M D3 | rate of that spin
CMOX CMOY CMOZ CMOX2 CMOY2 CMOZ2 | real | m | 0.0 | - | | M | axis of that spin
"""

MOTION = """
= computed
IMO | int | m | 0 | - | 0 2* 3 4 | M | motion of a component: 0 none, 3 as prescribed, 4 by the loads on it
IMOAXS | int | m | 0 | - | 0 1 2 3 4 | M | \
    freedom: 0 all six, 1 2 3 turns about an axis along x y z, 4 turns about a point
XAXS0 YAXS0 ZAXS0 | real | m | 0.0 | length | | M D3 | {axis} of a point of the fixed axis, or of the fixed point
XREF0 YREF0 ZREF0 | real | m | - | length | | M | \
    {axis} of the reference point of a prescribed motion; unset, the centre
IUMCAL IVMCAL IWMCAL | int | m | 1 | - | 0 1 | M | IMO=4: velocity along {axis} 1 follows the loads, 0 as prescribed
IOMXCAL IOMYCAL IOMZCAL | int | m | 1 | - | 0 1 | M | \
    IMO=4: turn about body axis {axis} 1 follows the loads, 0 as prescribed
IUPRE IVPRE IWPRE | int | m | 0 | - | 0 1 | M | prescribed velocity along {axis}: 0 constant or table, 1 sinusoid
IOMXPRE IOMYPRE IOMZPRE | int | m | 0 | - | 0 1 | M | prescribed turn about body axis {axis}: 0 table, 1 sinusoid
TOBS | real | t | 0.0 | time | | M | times of all tables of &obs
UTOBS VTOBS WTOBS | real | t:TOBS m | 0.0 | length/time | | M | \
    velocity along {axis}: prescribed, or at t=1 the initial one
OMXTOBS OMYTOBS OMZTOBS | real | t:TOBS m | 0.0 | radians/time | | M | \
    turn about body axis {axis}: prescribed, or at t=1 initial
UAMP VAMP WAMP | real | m | 0.0 | length/time | | M D3 | amplitude of a sinusoidal velocity along {axis}
UFRE VFRE WFRE | real | m | 0.0 | 1/time | | M D3 | frequency of a sinusoidal velocity along {axis}, cycles
UPHS VPHS WPHS | real | m | 0.0 | degrees | | M D3 | phase of a sinusoidal velocity along {axis}
OMXAMP OMYAMP OMZAMP | real | m | 0.0 | radians/time | | M | amplitude of a sinusoidal turn about body axis {axis}
OMXFRE OMYFRE OMZFRE | real | m | 0.0 | 1/time | | M | frequency of a sinusoidal turn about body axis {axis}, cycles
OMXPHS OMYPHS OMZPHS | real | m | 0.0 | degrees | | M | phase of a sinusoidal turn about body axis {axis}
DXMCMIN DYMCMIN DZMCMIN | real | m | 1e19 | length | >= 0 | M | \
    farthest way from the start towards lower {axis}, IMOAXS=0
DXMCMAX DYMCMAX DZMCMAX | real | m | 1e19 | length | >= 0 | M | \
    farthest way from the start towards higher {axis}, IMOAXS=0
ANGLMIN ANGLMAX | real | m | 1e19 | degrees | >= 0 | M | largest turn about a fixed axis, {side} side
= known
NEVENTS_GMO | int | m | 0 | - | >= 0 | M | number of events that change a prescribed motion
= known, with NEVENTS_GMO
EVENT_ACTION_GMO | int | k m | - | - | | M | what an event does
UTOBS_EVENT VTOBS_EVENT WTOBS_EVENT | real | k m | 0.0 | length/time | | M | velocity along {axis} after an event
OMXTOBS_EVENT OMYTOBS_EVENT OMZTOBS_EVENT | real | k m | 0.0 | radians/time | | M | turn about {axis} after an event
"""

FORCES = """
= computed
IPRPMVB | int | m | 0 | - | 0 1 | M | mass data: 0 from densities, 1 given as a whole
RHOMVB | real | m | 0.0 | mass/length3 | >= 0 | M | density of a body; at a free surface 1e-4 RHOF at least counts
RHOSUB | real | n | RHOMVB(m) | mass/length3 | >= 0 | M | density of a subcomponent
MASSMVB | real | m | - | mass | > 0 | M | mass of a body, IPRPMVB=1
XMCMVB0 YMCMVB0 ZMCMVB0 | real | m | - | length | | M | {axis} of the mass centre at the start, IPRPMVB=1
TJMVB | real | m i j | @inertia | mass length2 | | M | inertia tensor about the mass centre in body axes, IMOAXS 0 and 4
TJAXS | real | m | - | mass length2 | > 0 | M | moment of inertia about the fixed axis, IMOAXS 1 to 3
IGF | int | m | 0 | - | 0 1 2 | M | control loads: 0 none, 1 a force and a torque, 2 forces at points
IREFGF | int | m | 1 | - | 1 2 | M | axes of force and torque: 1 space, 2 body
FXTOBS FYTOBS FZTOBS | real | t:TOBS m | 0.0 | mass length/time2 | | M | control force along {axis} at the mass centre
TXTOBS TYTOBS TZTOBS | real | t:TOBS m | 0.0 | mass length2/time2 | | M | control torque about {axis}
FXTOBSM FYTOBSM FZTOBSM | real | t:TOBS m mf | 0.0 | mass length/time2 | | M | control force along {axis} at point mf
XFPNT YFPNT ZFPNT | real | m mf | - | length | | M | {axis} of point mf at the start; unset, the mass centre
IREFGFM | int | m mf | 1 | - | 1 2 | M | axes of the force at point mf: 1 space, 2 body
= computed
CRSTRNG | real | m | STRNGMOB | - | 0..1 | M T | Stronge's restitution of a component; a pair takes the smaller one
CFRC | real | m | FRCMOB | - | >= 0 | M T | Coulomb friction of a component; a pair takes the smaller one
ICLIDOB | int | m m | ICLID | - | 0 1 | M T | 0 lets a pair pass through each other; (m,m)=0 takes m out of all
= known
NSPRP | int | | 0 | - | 0..100 | M D3 | number of springs, ropes and mooring lines
= known, with NSPRP
IFSP | int | nsp | 2 | - | 1 2 3 4 5 6 | M | kind of spring: 1 rope, 2 to 4 linear, 5 torsion, 6 mooring line
IOBSP1 IOBSP2 | int | nsp | 0 | - | 0..500 | M | component at the {side} end; 0 fixed in space
XSP01 YSP01 ZSP01 | real | nsp | - | length | | M | {axis} of the first end at the start
XSP02 YSP02 ZSP02 | real | nsp | - | length | | M | {axis} of the second end at the start
ASP | real | nsp | - | length | >= 0 | M | free length; unset, the distance at the start
BSP | real | nsp | - | length | >= 0 | M | length when blocked; unset, a tenth of the free length
CSP | real | nsp | - | mass/time2 | >= 0 | M | stiffness; of a torsion spring per degree
DMPSP | real | nsp | 0.0 | mass/time | >= 0 | M | damping
TSP0 | real | nsp | 0.0 | mass length2/time2 | | M | torque of a torsion spring at the start
CSPUNIT | real | nsp | - | mass length/time2 | | M | stiffness of a mooring line times its length
DIASP | real | nsp | - | length | > 0 | M | diameter of a mooring line
RHOSP | real | nsp | - | mass/length | > 0 | M | mass of a unit of length
RHOSP_MAT | real | nsp | - | mass/length3 | > 0 | M | density of its material
CDSPN | real | nsp | 1.0 | - | >= 0 | M | drag across a mooring line
CDSPT | real | nsp | 0.3 | - | >= 0 | M | drag along a mooring line
NSEGSP | int | nsp | 31 | - | >= 1 | M | segments of a mooring line
FSPBRK | real | nsp | 1e35 | mass length/time2 | > 0 | M | load at which a mooring line breaks
XSPMN XSPMX YSPMN YSPMX ZSPMN ZSPMX | real | nsp | @unbounded | length | | M | \
    {side} wall that confines a line in {axis}
IF_SPRP_ENABLED | int | nsp | 1 | - | 0 1 | M | 0 leaves a spring out
SPRINGNAME | char | nsp | '' | - | | M | name of a spring
"""

TABLES = (("OBS", GEOMETRY), ("OBS", MOTION), ("OBS", FORCES))
