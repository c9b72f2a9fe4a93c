"""Several contacts that touch, resolved together by the energy law of Liu, Zhao & Brogliato, with Coulomb friction.

Law. Contact j stores the work of its compression, E_j, and the impulses of an instant share as the forces of equal
springs f = k δ^η do (η 3/2 Hertz, 1 linear), which are powers of the energies:

    dp_j / dp_i = (E_j / E_i)^(η/(1+η))
    dE_j = -v_j dp_j  while it closes (v_j < 0),     dE_j = -v_j dp_j / e_j²  while it opens

so that e_j² of what was stored comes back, and the contact is over when E_j = 0. It may close again while others still
push; then it starts anew. With e_j = 0 all of E_j is lost at the moment when the closing ends. The cluster is over when
nothing approaches and all E_j are zero. One contact alone gives Stronge's law.

Regular form. In s_j = E_j^(1/(1+η)), up to a factor the depth δ_j, and the time t that the springs make (dp_j = f_j dt;
their common stiffness only sets its unit, and is 1),

    dδ_j/dt = -v_j (closing), -v_j / e_j² (opening),    dv/dt = K f,    f_j = δ_j^η, |f_t| <= μ_j f_j,    δ_j(0) = 0

which also starts by itself: δ_j = -v_j t at first. The bodies do not move meanwhile. Friction opposes the slip, and
holds where the cone allows.

Steps (cluster_step.py) have h ω <= `fraction`, ω the fastest swing of the springs at that moment; the error falls
with its square. The energy is exact at any step. Contacts that feel nothing (E_j = 0, v_j >= 0) are not touched: a
sweep goes over the active contacts, and the search for new ones over those that an active one pushes.

Events. Where a contact with e = 0 stops closing or slip halts, a step ends: its length is found by regula falsi, first
on the guess with which a step begins, which costs a third of a sweep, then on the step itself.

What small and large clusters are worth. The velocities after a few contacts are a law of nature; those after a hundred
rough ones, chaotic: each contact that stops or halts a little later changes them by more. So the tolerances grow with
the number of contacts, up to three times coarser steps: velocities to about 1e-3 of the largest change in place of
1e-4 (captured dominoes, heaps of spheres and of cubes: medians 1e-4 to 7e-4). From 100 contacts on, what is too slow to
matter, and left to the plastic end, grows up to four times more. The speed of what goes on in a cluster falls by equal
factors in equal numbers of steps, so that to stop at 1e-3 halves them.

Sources: Liu, Zhao & Brogliato 2008, Proc. R. Soc. A 464, 3193; 2009, 465, 1; friction as in Jia & Wang 2017.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.cluster_step import ROUND_OFF, accept, regroup, step_length, sweep
from flowgmo.collision.coupling import any_rough, couple, no_gain, write_back
from flowgmo.collision.friction import halt
from flowgmo.collision.plastic import CLOSE, IN_VAIN, SOFT, largest_approach, settle, start_again, sweeps_for
from flowgmo.kernel import inner, kernel
from flowgmo.records import CLUSTER, SLIP, STICK

# how a cluster can end
DONE = 0
UNFINISHED = 1  # the bound on steps was met, or a step gave no numbers: the rest was resolved as plastic
IMPOSSIBLE = 2  # driven bodies leave no velocity without approach: least violation
# phases: whether there is a velocity without approach; the law, and a plastic end for what was slow enough to be left,
# locked, or unfinished; the least violation
TRY, LAW, LEAST, END = 0, 1, 2, 3
AT_REST = 1e-9  # approach [v_ref] that counts as none where e = 1: its energy is round-off
NEARLY = 1e-3  # of the first approach × fraction, the same for e < 1: far below the error of the steps
LOCKED = 1e-3  # speed, of the one that the stored energy can give, below which nothing moves
# what follows is in first approaches × fraction², as the error of the steps
SLACK = 1e-4  # change that sweeps may leave where there is friction: 1e-6 gives nothing better
TURN = 0.02  # normal velocity after the end of a contact with e = 0, and slip that counts as none: many add up
OVER = 0.1  # speed below which a large cluster is over
FEW, FEW_ROUGH = 64, 8  # contacts, frictionless and rough, above which steps and tolerances grow with their number
COARSEST_STEPS = 3.0  # to so many times `fraction`: a step is then a tenth of a swing and still resolves it
CROWD, CROWDED = 100, 4.0  # contacts above which NEARLY and OVER grow with their number too, and to how many times
SWEEPS = 50  # in one try: friction of redundant contacts may leave more than `enough` after it
TRIES = 60  # for one step: two or three an event; at the bound the last try is made real, its energy is exact too


@inner
def _collect(springs, near, number, active, nearly):
    """Fill active with the contacts that store energy or approach, by more than nearly [v_ref] where e < 1.

    near[:number]: where to look. Returns their number, whether the set is a new one, and the largest speed that is
    left: of an approach, or of what the stored energy can give; infinite where one has e = 1: its energy is to be kept.
    """
    count = np.int64(0)
    changed = False
    speed = 0.0
    for k in range(number):
        i = near[k]
        s = springs[i]
        least = AT_REST if s.rate == 1.0 else nearly
        acts = 1 if s.own[2, 2] > 0.0 and (s.stored > 0.0 or s.v[2] < -least) else 0
        if acts != s.active:
            changed = True
            s.active = acts
            s.rise = 0.0
            s.tilt[0], s.tilt[1], s.tilt[2] = 0.0, 0.0, 0.0
        if acts == 1:
            active[count] = i
            count += 1
            left = max(s.v[2] * s.v[2], 2.0 * s.own[2, 2] * s.stored)
            speed = max(speed, left) if s.rate != 1.0 else np.inf
    return count, changed, np.sqrt(speed)


@inner
def _earliest(springs, active, count, turn, still, halts):
    """Fraction of the tried step after which something changes that a step must not hold in its middle; 1: nothing.

    A contact with e = 0 stops closing, by more than turn [v_ref], or slip above still [v_ref] halts.
    """
    first = 1.0
    for i in range(count):
        s = springs[active[i]]
        v, w = s.v[2], s.end[2]
        if s.rate == 0.0 and v < -turn and w > turn:
            first = min(first, v / (v - w))
        if s.mu > 0.0 and halts:
            first = min(first, halt(s, still))
    return first


@inner
def _locked(springs, active, count):
    """Whether energy is stored and yet nothing moves: what one step moves must be far more at any other time."""
    moves = 0.0
    could = 0.0
    for i in range(count):
        s = springs[active[i]]
        moves = max(moves, s.v[2] * s.v[2])
        could = max(could, 2.0 * s.own[2, 2] * s.stored)
    return moves < LOCKED * LOCKED * could


@inner
def _finite(springs, active, count):
    """Whether the end velocities of the tried step are numbers; impulses that are none would show in them."""
    total = 0.0
    for i in range(count):
        w = springs[active[i]].end
        total += w[0] * w[0] + w[1] * w[1] + w[2] * w[2]
    return total < np.inf


@inner
def _tolerances(springs, rough, fraction):
    """The fraction to step with, enough, turn, still, nearly, over, all but the first in v_ref.

    enough: change by a sweep; turn, still: see _earliest; nearly: see _collect; over: largest speed of a cluster that
    is over, zero for small ones.
    """
    m = springs.shape[0]
    first = largest_approach(springs)
    coarse = max(1.0, min(m / (FEW_ROUGH if rough else FEW), COARSEST_STEPS))
    crowd = max(1.0, min(m / CROWD, CROWDED))
    x = coarse * fraction
    enough, turn, still = ROUND_OFF, ROUND_OFF, 0.0
    if rough:
        enough = max(SLACK * coarse**3 * x * x * first, ROUND_OFF)
        turn = max(TURN * x * x * first, ROUND_OFF)
        still = max(turn, 10.0 * enough)  # sweeps leave that of a stick
    nearly = max(NEARLY * crowd * coarse * x * first, 10.0 * ROUND_OFF)
    over = OVER * crowd * x * x * first if coarse > 1.0 else 0.0
    return x, enough, turn, still, nearly, over


@inner
def _find_step(springs, links, active, count, h, eta, rough, tolerances):
    """Find dp and end of a step of length h, or of a shorter one that ends with the first event. Returns its length."""
    _, enough, turn, still, _, _ = tolerances
    swept = False
    for _ in range(TRIES):
        change = sweep(springs, links, active, count, h, eta, rough, SWEEPS if swept else 0, enough)
        first = _earliest(springs, active, count, turn, still, swept)
        if not rough and change > 10.0 * enough and first == 1.0:
            first = 0.5  # the sweeps do not settle
        if first == 1.0 and swept:
            break
        swept = first == 1.0
        h *= first
    return h


@inner
def _integrate(springs, links, eta, fraction, rough, most):
    """Step until nothing is stored and nothing approaches, or what is stored cannot come out or is of no account.

    Returns whether `most` steps did, each of them with numbers. If not, and where it is locked, energy is still stored.
    """
    m = springs.shape[0]
    active = np.zeros(m, np.int64)
    near = np.zeros(m, np.int64)
    for i in range(m):
        near[i] = i
    number = np.int64(m)
    tolerances = _tolerances(springs, rough, fraction)
    fraction, _, turn, _, nearly, over = tolerances
    h = 0.0
    locked = np.int64(0)
    for _ in range(most):
        count, changed, speed = _collect(springs, near, number, active, nearly)
        if count == 0 or speed < over:
            return True
        if changed:
            number = regroup(springs, links, active, count, near, number)
        locked = locked + 1 if _locked(springs, active, count) else 0
        if locked > 20:  # steps; where it turns without being locked it moves on at the next
            return True
        h = step_length(springs, active, count, h, eta, fraction)
        part = _find_step(springs, links, active, count, h, eta, rough, tolerances)
        if not _finite(springs, active, count):
            return False
        accept(springs, links, active, count, part, eta, turn)
    return False


@inner
def _driven(contacts, responses, twists):
    """Whether some party has a motion that no impulse changes."""
    for i in range(contacts.shape[0]):
        for party in (contacts[i].a, contacts[i].b):
            r, t = responses[party], twists[party]
            for k in range(3):
                if (r.wt[k] == 0.0 and t.v[k] != 0.0) or (r.wr[k] == 0.0 and t.w[k] != 0.0):
                    return True
    return False


@kernel
def resolve(contacts, responses, twists, eta, fraction):
    """Resolve contacts (m,) of CONTACT that touch, together.

    responses, twists (n,): of the parties; eta [-]: exponent of the springs; fraction [-]: step h ω of a small cluster,
    0.03 gives velocities to 1e-4, and 0.01 to 1e-5; of a large one see the module. Writes impulse, regime, loss of the
    contacts and the twists after. Returns status and the largest approach speed that is left [length/time].
    ½ (v⁻ + v⁺)·J summed, which is the change of the kinetic energy where no party is driven, does not rise and is minus
    the sum of the losses; |Jt| <= μ Jn. Input that is not finite is left as it is (UNFINISHED, inf); other input gives
    numbers.
    """
    rough = any_rough(contacts)
    m = contacts.shape[0]
    springs, links, v_ref, k_ref = couple(contacts, responses, twists, rough)
    if largest_approach(springs) == np.inf:
        return UNFINISHED, np.inf
    status = DONE
    phase = TRY if _driven(contacts, responses, twists) else LAW
    if k_ref == 0.0:
        status = IMPOSSIBLE if largest_approach(springs) > 0.0 else DONE
        phase = END
    while phase != END:  # a loop, because each place that calls compiles its own copy of what it calls
        if phase == LAW:
            if not _integrate(springs, links, eta, fraction, rough, int((200.0 + 20.0 * m) / fraction)):
                status = UNFINISHED  # a swing takes 3 / fraction steps, a wave through m contacts m swings
            if largest_approach(springs) <= ROUND_OFF:
                break
        left = settle(springs, links, sweeps_for(m), SOFT if phase == LEAST else 0.0, CLOSE)
        if phase == LEAST:
            status = IMPOSSIBLE
        if phase == LEAST or (phase == LAW and left <= IN_VAIN):
            break
        start_again(springs)
        phase = LEAST if left > IN_VAIN else LAW
    if largest_approach(springs) == np.inf:  # the last resort: no impulse at all
        status = UNFINISHED
        start_again(springs)
    no_gain(springs)
    write_back(springs, contacts, responses, twists, v_ref, k_ref if k_ref > 0.0 else 1.0)
    for i in range(m):
        contacts[i].regime = CLUSTER
    if m == 1:
        slip = springs[0].v[0] * springs[0].v[0] + springs[0].v[1] * springs[0].v[1]
        contacts[0].regime = (
            STICK if contacts[0].mu > 0.0 and slip <= (100.0 * SLACK * fraction * fraction) ** 2 else SLIP
        )
    return status, largest_approach(springs) * v_ref
