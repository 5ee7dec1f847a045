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

struct Divergence {
    int id;
    std::vector<int> active, arrived;
    std::vector<std::vector<int>> sides;  // still to run
};

struct Warp {
    std::vector<Divergence> stack;
};

bool done(int lane) { return m.fibers[size_t(lane)].state == DONE; }

std::vector<int> running(const Divergence& top) {
    std::vector<int> lanes;
    for (int lane : top.active)
        if (!done(lane)) lanes.push_back(lane);
    return lanes;
}

void shuffle(std::vector<int>& lanes) {
    for (size_t i = lanes.size(); i > 1; --i) std::swap(lanes[i - 1], lanes[size_t(choose(SIDE, int(i)))]);
}

void resume(const std::vector<int>& lanes) {
    for (int lane : lanes) {
        if (m.failure) return;
        switch_to(&m.fibers[size_t(lane)]);
    }
}

// All sides have come to the end of the branch: its lanes go on together.
void converge(Warp& warp) {
    Divergence& top = warp.stack.back();
    top.active.clear();
    if (!top.sides.empty()) {
        top.active = top.sides.back();
        top.sides.pop_back();
        return;
    }
    std::vector<int> lanes = top.arrived;
    warp.stack.pop_back();
    if (!warp.stack.empty()) {
        warp.stack.back().active = lanes;
        resume(lanes);
    }
}

void take_branch(Warp& warp, const std::vector<int>& lanes) {
    std::vector<int> side[2];
    for (int lane : lanes) side[m.fibers[size_t(lane)].condition].push_back(lane);
    if (!side[0].empty() && !side[1].empty()) {
        const Fiber& first = m.fibers[size_t(lanes[0])];
        int id = m.options.late && first.returns ? SHADER_END : first.event_id;
        int chosen = choose(SIDE, 2);
        if (warp.stack.back().id != id || id == SHADER_END) warp.stack.push_back({id, {}, {}, {}});
        Divergence& top = warp.stack.back();
        top.active = side[chosen];
        top.sides.push_back(side[1 - chosen]);
    }
    resume(warp.stack.back().active);
}

// One step of a warp: an access of all lanes that stand before one, else what the lanes have come to.
void step(Warp& warp) {
    Divergence& top = warp.stack.back();
    std::vector<int> lanes = running(top), accesses, ends, passing;
    top.active = lanes;
    if (lanes.empty()) {
        converge(warp);
        return;
    }
    for (int lane : lanes) {
        const Fiber& f = m.fibers[size_t(lane)];
        if (f.event == ACCESS) accesses.push_back(lane);
        else if (f.event == JOIN) (f.event_id == top.id ? ends : passing).push_back(lane);
    }
    if (!accesses.empty()) {
        shuffle(accesses);
        resume(accesses);
    } else if (!passing.empty()) {
        resume(passing);
    } else if (!ends.empty()) {
        top.active.clear();
        for (int lane : lanes)
            (m.fibers[size_t(lane)].event == JOIN ? top.arrived : top.active).push_back(lane);
    } else {
        int id = m.fibers[size_t(lanes[size_t(choose(SIDE, int(lanes.size())))])].event_id;
        std::vector<int> alike;
        for (int lane : lanes)
            if (m.fibers[size_t(lane)].event_id == id) alike.push_back(lane);
        if (alike.size() == lanes.size()) {
            take_branch(warp, alike);
        } else {  // lanes at different branches: some go on, the others wait with them for the end of this one
            std::vector<int> rest;
            for (int lane : lanes)
                if (m.fibers[size_t(lane)].event_id != id) rest.push_back(lane);
            top.active = alike;
            top.sides.push_back(rest);
        }
    }
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
    std::vector<Warp> warps;
    for (int id = 0; id < m.used; ++id) {
        if (id % m.options.warp == 0) warps.push_back({{{SHADER_END, {}, {}, {}}}});
        warps.back().stack[0].active.push_back(id);
    }
    while (!warps.empty() && !m.failure) {
        size_t which = size_t(choose(SIDE, int(warps.size())));
        step(warps[which]);
        if (warps[which].stack.empty()) warps.erase(warps.begin() + long(which));
        if (m.steps - m.last_change > STANDSTILL && !m.failure) m.failure = "stuck";
    }
}
}  // namespace race
