"""Contacts that stay closed over a step, as constraints with friction.

The engine advances touching bodies by small steps. Given the twists they would have at the end of the step without
contact forces, find impulses p of the contacts so that with u, the relative velocity at the END of the step,

    0 <= p_n ⟂ u_n + bias >= 0      |p_t| <= μ p_n      u_t = 0 (sticks) or p_t = -μ p_n u_t/|u_t| (slides)

bias = gap/h >= 0 lets a contact that is still open close. This is Moreau's implicit step with Coulomb's law itself:
sliding contacts do not separate as they do in convex relaxations. As u is that at the end, an impulse opposes what is
left, u·p <= 0, and with no work from outside the kinetic energy changes by u·p - p·W p/2 <= 0.

Method. Contacts that depend on each other form groups (links.py), each solved on its own:
  1. the guess, the forces of the last step, is tried first; if the natural map p = clip(p - u/k) holds, that is all
  2. a single contact: exact solution (one_contact.py)
  3. else proximal Newton (contact_newton.py): independent of numbering, a few steps for stacks and mass ratios
  4. if that fails (large μ: Coulomb's problem may have many solutions, or none), symmetric block Gauss-Seidel: contact
     after contact solved exactly with the others held, forwards, then backwards (Jourdan, Alart & Jean 1998)
Factors of a matrix cost its size times its band squared. Chains and walls have a narrow band; heaps of a hundred bodies
have not: where the factors would cost more than WORK only sweeps are made, to COARSE. Step after step they start from
better forces, and a heap that comes to rest is solved to the tolerance all the same. What rests may cost more, once.

Source: Moreau 1988; Jean 1999; Alart & Curnier 1991; Acary & Brogliato 2008, ch. 13.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.contact import symmetric_times
from flowgmo.collision.contact_groups import find_groups
from flowgmo.collision.contact_newton import CONVERGED, IMPOSSIBLE, TOO_MANY, newton, start
from flowgmo.collision.links import (
    LINK,
    SLOT,
    guess,
    is_solved,
    mass_unit,
    move,
    natural_residual,
    prepare_link,
    prepare_slots,
    velocity,
)
from flowgmo.collision.one_contact import solve_one
from flowgmo.kernel import inner, kernel
from flowgmo.vectors import dot, norm, put, scale, sub, triple

WORK = 2e8  # multiplications that factors may cost in one solution, a tenth of a second
CALM_WORK = 1e9  # the same for bodies that rest: their forces are found once, and are the next steps' guess
CALM = 5.0  # free normal speeds, which rest leaves to gravity: both sides' speeds are no more than that where all rests
LEAST_STEPS = 40  # else no factors at all; the pyramid of decks/stack takes 43, in its first step
COARSE = 1e-4  # of the free normal speed: what a large group is solved to in its first step
ENOUGH = 60  # sweeps of such a group: the next step goes on from there
NEARER = 0.1  # of the guess's residual: what it is solved to later, until the tolerance is met
NEWTON_MOST = 300  # steps; random piles of 12 bodies that are solved at all take up to 200


@inner
def sweep(links, slots, group, backwards):
    """Solve every contact of a group once, the others held."""
    for i in range(group.last - group.first):
        link = links[group.last - 1 - i if backwards else group.first + i]
        if link.k > 0.0:
            p = triple(link.p)
            v = sub(velocity(slots, link), symmetric_times(link.kk, p))
            new = solve_one(link.kk, triple(link.n), link.mu, v)
            move(slots, link, sub(new, p))
            put(link.p, new)


@inner
def sweep_until(links, slots, group, tolerance, most):
    """Sweeps forwards and backwards until the natural map holds; returns their number, relative residual, status."""
    count = np.int64(0)
    while count < most and not is_solved(links, slots, group, tolerance):
        sweep(links, slots, group, count % 2 == 1)
        count += 1
    residual, _ = natural_residual(links, slots, group, tolerance)
    return count, residual, CONVERGED if residual <= tolerance else TOO_MANY


@inner
def allow(links, slots, group):
    """Let every contact approach as it does now: what cannot be avoided becomes part of the bias.

    Returns the largest such speed, and the largest free relative velocity of the group.
    """
    most = 0.0
    size = 0.0
    for c in range(group.first, group.last):
        link = links[c]
        n = triple(link.n)
        much = min(dot(velocity(slots, link), n), 0.0)
        size = max(size, norm(triple(link.u0)))
        most = max(most, -much)
        put(link.u0, sub(triple(link.u0), scale(much, n)))
    return most, size


@inner
def restart(links, slots, group, contacts, unit):
    """Back to the guess."""
    for c in range(group.first, group.last):
        guess(links[c], contacts[links[c].contact], unit)
    start(links, slots, group)


@inner
def is_calm(links, group):
    """Whether nothing in a group moves faster than what gravity gives it in the step."""
    free = 0.0
    size = 0.0
    for c in range(group.first, group.last):
        link = links[c]
        free = max(free, abs(dot(triple(link.u0), triple(link.n))))
        size = max(size, link.size)
    return size <= CALM * free


@inner
def solve_group(links, slots, group, contacts, unit, tolerance, most):
    """Impulses and y of one group; returns sweeps and steps, relative residual, status."""
    start(links, slots, group)
    first, _ = natural_residual(links, slots, group, tolerance)
    if first <= tolerance:
        return np.int64(0), first, CONVERGED
    count = np.int64(0)
    n = 6 * (group.high - group.low)
    reach = 6 * group.band + 5
    forced = 0.0
    factors = 2.0 * n * reach * reach  # multiplications
    calm = is_calm(links, group)
    steps = min(most, NEWTON_MOST, np.int64((CALM_WORK if calm else WORK) / factors))
    if group.last - group.first > 1 and steps >= LEAST_STEPS and tolerance < COARSE:
        for _ in range(2):
            more, residual, status = newton(links, slots, group, tolerance, steps)
            count += more
            if forced > 0.0:
                return count, max(forced, residual), IMPOSSIBLE
            if status == CONVERGED:
                return count, residual, CONVERGED
            if status == TOO_MANY:
                break
            much, free = allow(links, slots, group)
            forced = much / free
            restart(links, slots, group, contacts, unit)
        if residual > first:
            restart(links, slots, group, contacts, unit)
    if steps < most:
        tolerance = max(tolerance, min(COARSE, NEARER * first))
        most = most if calm else min(most, ENOUGH)
    more, residual, status = sweep_until(links, slots, group, tolerance, most)
    return count + more, residual, status


@kernel
def solve(contacts, bias, responses, twists, tolerance, most):
    """Impulses of persistent contacts and the twists at the end of the step.

    contacts (m,) CONTACT: impulse holds the guess, that of the last step, and on return the solution, space axes;
    bias (m, 3) [length/time]: velocity added to that of each contact before the law is applied, space axes: along the
    normal the speed at which it may still close; responses (n,) RESPONSE;
    twists (n,) TWIST: free ones at the end of the step, changed in place; most: bounds the sweeps of each group.
    Contacts of two parties that answer nothing are left out, their impulse is zero.
    Returns the largest number of sweeps and Newton steps of a group; the largest residual, k |p - clip(p - u/k)| of a
    contact over its group's largest free normal velocity (see natural_residual); the worst status: CONVERGED 0,
    TOO_MANY 1 (tolerance not met), IMPOSSIBLE 2 (no solution, as where driven parties crush one: least violation,
    residual relative to the largest free velocity, impulses no larger than the other contacts ask for).
    """
    groups, n_groups, queue, n_slots, slot_of, order, n_links = find_groups(contacts, responses)
    slots = np.empty(n_slots, SLOT)
    lt = np.empty((n_slots, 3, 3))
    lr = np.empty((n_slots, 3, 3))
    links = np.empty(n_links, LINK)
    for c in range(len(contacts)):
        if slot_of[contacts[c].a] < 0 and slot_of[contacts[c].b] < 0:
            put(contacts[c].impulse, (0.0, 0.0, 0.0))
    count = np.int64(0)
    residual = 0.0
    status = CONVERGED
    for g in range(n_groups):
        group = groups[g]
        unit = mass_unit(contacts, order, group, responses)
        prepare_slots(slots, group, queue, responses, unit, lt, lr)
        for i in range(group.first, group.last):
            contact = contacts[order[i]]
            links[i].contact = order[i]
            links[i].a = slot_of[contact.a]
            links[i].b = slot_of[contact.b]
            prepare_link(links[i], contact, bias, order[i], responses, twists, lt, lr, unit)
        sweeps, worst, how = solve_group(links, slots, group, contacts, unit, tolerance, most)
        count = max(count, sweeps)
        residual = max(residual, worst)
        status = max(status, how)
        for i in range(group.first, group.last):
            put(contacts[order[i]].impulse, scale(1.0 / unit, triple(links[i].p)))
    for s in range(n_slots):
        finish(twists[slots[s].party], slots[s].y, lt[s], lr[s])
    return count, residual, status


@inner
def finish(twist, y, lt, lr):
    """Add a party's change to its twist."""
    for i in range(3):
        for k in range(3):
            twist.v[i] += lt[i, k] * y[k]
            twist.w[i] += lr[i, k] * y[3 + k]
