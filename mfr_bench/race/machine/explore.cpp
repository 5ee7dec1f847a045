// Every schedule with at most `bound` deviations from what happens by default: depth first, each from the start.
#include "machine.hpp"

namespace race {
namespace {
struct Point { int alternatives, taken; bool free; };
std::vector<Point> path;
size_t at;
int spent;
}  // namespace

void exhaust_begin() {
    path.clear();
    at = 0;
    spent = 0;
}

// Who goes on where somebody has ended or waits costs nothing; every other deviation counts against the bound.
int exhaust(int kind, int alternatives) {
    bool free = kind == NEXT;
    if (at == path.size()) path.push_back({free || spent < m.options.bound ? alternatives : 1, 0, free});
    Point& p = path[at++];
    if (!p.free && p.taken) ++spent;
    return p.taken;
}

bool exhaust_next() {
    path.resize(at);
    at = 0;
    spent = 0;
    while (!path.empty() && path.back().taken + 1 >= path.back().alternatives) path.pop_back();
    if (path.empty()) return false;
    ++path.back().taken;
    return true;
}
}  // namespace race
