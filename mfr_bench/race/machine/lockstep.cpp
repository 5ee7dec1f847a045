// Warps whose lanes run in lockstep: at a divergent branch either side goes first, and waits at the end of the branch
// for the other. A stack of such branches per warp, as in Levinthal and Porter 1984. With `late` a branch in which a
// function returns ends only where the shader does, as after a compiler that has moved the return.
#include "machine.hpp"

namespace race {
bool lockstep_on = false;

namespace {
enum What { ACCESS, BRANCH, JOIN };
constexpr int SHADER_END = -1;
constexpr uint64_t STANDSTILL = 20'000;  // accesses without a change of memory
constexpr int MOST_LANES = 64;
using Lanes = uint64_t;                  // a bit for each lane of a warp

struct Divergence {
    int id;
    Lanes active, arrived;
    std::vector<Lanes> sides;  // still to run
};

struct Warp {
    int first;  // fiber of its lane 0
    std::vector<Divergence> stack;
    int depth;  // of the stack, as far as it is used: what is behind keeps its memory
};

Fiber& fiber_of(const Warp& warp, int lane) { return m.fibers[size_t(warp.first + lane)]; }
int lowest(Lanes lanes) { return __builtin_ctzll(lanes); }
int count(Lanes lanes) { return __builtin_popcountll(lanes); }
Lanes bit(int lane) { return Lanes(1) << lane; }
Divergence& top_of(Warp& warp) { return warp.stack[size_t(warp.depth - 1)]; }

template <class F> void each_lane(Lanes lanes, F f) {
    for (; lanes; lanes &= lanes - 1) f(lowest(lanes));
}

Lanes running(const Warp& warp, Lanes lanes) {
    each_lane(lanes, [&](int lane) { if (fiber_of(warp, lane).state == DONE) lanes &= ~bit(lane); });
    return lanes;
}

void push(Warp& warp, int id) {
    if (size_t(warp.depth) == warp.stack.size()) warp.stack.emplace_back();
    Divergence& d = warp.stack[size_t(warp.depth++)];
    d.id = id;
    d.active = d.arrived = 0;
    d.sides.clear();
}

void resume(const Warp& warp, Lanes lanes) {
    for (; lanes && !m.failure; lanes &= lanes - 1) switch_to(&fiber_of(warp, lowest(lanes)));
}

// The lanes make their access one after the other, in any order.
void access(const Warp& warp, Lanes lanes) {
    int order[MOST_LANES], n = 0;
    each_lane(lanes, [&](int lane) { order[n++] = lane; });
    for (int i = n; i > 1; --i) std::swap(order[i - 1], order[choose(SIDE, i)]);
    for (int i = 0; i < n && !m.failure; ++i) switch_to(&fiber_of(warp, order[i]));
}

// All sides have come to the end of the branch: its lanes go on together.
void converge(Warp& warp) {
    Divergence& top = top_of(warp);
    if (!top.sides.empty()) {
        top.active = top.sides.back();
        top.sides.pop_back();
        return;
    }
    Lanes lanes = top.arrived;
    if (!--warp.depth) return;
    top_of(warp).active = lanes;
    resume(warp, lanes);
}

void take_branch(Warp& warp, Lanes lanes) {
    Lanes side[2] = {0, 0};
    each_lane(lanes, [&](int lane) { side[fiber_of(warp, lane).condition] |= bit(lane); });
    if (side[0] && side[1]) {
        const Fiber& first = fiber_of(warp, lowest(lanes));
        int id = m.options.late && first.returns ? SHADER_END : first.event_id, chosen = choose(SIDE, 2);
        if (top_of(warp).id != id || id == SHADER_END) push(warp, id);
        top_of(warp).active = side[chosen];
        top_of(warp).sides.push_back(side[1 - chosen]);
    }
    resume(warp, top_of(warp).active);
}

// Lanes that stand at branches: those at one of them take it; the others wait with them for its end.
void branches(Warp& warp, Lanes lanes) {
    int which = choose(SIDE, count(lanes));
    Lanes left = lanes, alike = 0;
    while (which--) left &= left - 1;
    int id = fiber_of(warp, lowest(left)).event_id;
    each_lane(lanes, [&](int lane) { if (fiber_of(warp, lane).event_id == id) alike |= bit(lane); });
    if (alike == lanes) {
        take_branch(warp, alike);
        return;
    }
    top_of(warp).active = alike;
    top_of(warp).sides.push_back(lanes & ~alike);
}

// One step of a warp: an access of all lanes that stand before one, else what the lanes have come to.
void step(Warp& warp) {
    Divergence& top = top_of(warp);
    Lanes lanes = top.active = running(warp, top.active), accesses = 0, ends = 0, passing = 0;
    each_lane(lanes, [&](int lane) {
        const Fiber& f = fiber_of(warp, lane);
        if (f.event == ACCESS) accesses |= bit(lane);
        else if (f.event == JOIN) (f.event_id == top.id ? ends : passing) |= bit(lane);
    });
    if (!lanes) converge(warp);
    else if (accesses) access(warp, accesses);
    else if (passing) resume(warp, passing);
    else if (ends) top.arrived |= ends, top.active &= ~ends;
    else branches(warp, lanes);
}

std::vector<Warp> warps;  // kept from frame to frame, for their memory

// As many warps as the fragments fill, in order of submission.
int fill_warps() {
    int count = 0;
    for (int id = 0; id < m.used; id += m.options.warp, ++count) {
        if (size_t(count) == warps.size()) warps.emplace_back();
        Warp& warp = warps[size_t(count)];
        int lanes = m.used - id < m.options.warp ? m.used - id : m.options.warp;
        warp.first = id;
        warp.depth = 0;
        push(warp, SHADER_END);
        top_of(warp).active = lanes == MOST_LANES ? ~Lanes(0) : bit(lanes) - 1;
    }
    return count;
}
}  // namespace

static void wait_for_warp(int what, int id) {
    m.current->event = what;
    m.current->event_id = id;
    switch_to(nullptr);
    m.current->event = ACCESS;
}

bool lockstep_branch(bool condition, int id, bool returns) {
    if (m.solo) return condition;
    m.current->condition = condition;
    m.current->returns = returns;
    wait_for_warp(BRANCH, id);
    return condition;
}

void lockstep_join(int id) {
    if (!m.solo) wait_for_warp(JOIN, id);
}

void run_lockstep() {
    int left = fill_warps();
    while (left && !m.failure) {
        if (m.options.weak) drain_some();
        size_t which = size_t(choose(SIDE, left));
        step(warps[which]);
        if (!warps[which].depth) std::swap(warps[which], warps[size_t(--left)]);
        if (m.steps - m.last_change > STANDSTILL && !m.failure) m.failure = "stuck";
    }
}
}  // namespace race
