// Fibers, and who goes on: at random, by priorities, exhaustively, or as told.
// Priorities: probabilistic concurrency testing, Burckhardt et al. 2010.
#include "machine.hpp"
#include <cstdlib>
#if !defined(__x86_64__)
#include <ucontext.h>
#endif

namespace race {
constexpr size_t STACK_BYTES = 64 * 1024;
constexpr uint64_t MOST_STEPS = 400'000;  // of one frame
constexpr uint32_t STUCK = 64;              // rounds in which everyone waits
constexpr int MOST_WITH_PRIORITY = 64;       // invocations; with more, who goes on is drawn
constexpr uint32_t WAITS = 2;               // repeats of one access after which an invocation is known to wait

static void join_ready(Fiber& f);
static void start_next_of_pixel(const Fiber& f);

static void body() {
    m.pass->run();
    m.current->state = DONE;
    --m.live;
    if (m.pass->fetches) {
        raster_now(*m.current);
        start_next_of_pixel(*m.current);
    } else if (m.held < m.used) {
        join_ready(m.fibers[size_t(m.held++)]);
    }
    pause_current();
    std::abort();
}

#if defined(__x86_64__)
extern "C" void race_switch(void** from, void* to);
__asm__(R"(
.text
.globl race_switch
.type race_switch,@function
race_switch:
    pushq %rbp
    pushq %rbx
    pushq %r12
    pushq %r13
    pushq %r14
    pushq %r15
    movq %rsp, (%rdi)
    movq %rsi, %rsp
    popq %r15
    popq %r14
    popq %r13
    popq %r12
    popq %rbx
    popq %rbp
    ret
.size race_switch,.-race_switch
)");

static void prepare(Fiber& f) {
    void** top = reinterpret_cast<void**>(f.stack + STACK_BYTES) - 2;  // the stack is as at a call: 16 bytes, less 8
    top[0] = reinterpret_cast<void*>(body);
    top[1] = nullptr;
    for (int i = 1; i <= 6; ++i) top[-i] = nullptr;
    f.sp = top - 6;
}

static void change(void** from, void* to) { race_switch(from, to); }
#else
static void prepare(Fiber& f) {
    auto* context = f.sp ? static_cast<ucontext_t*>(f.sp) : new ucontext_t;
    getcontext(context);
    context->uc_stack.ss_sp = f.stack;
    context->uc_stack.ss_size = STACK_BYTES;
    context->uc_link = nullptr;
    makecontext(context, body, 0);
    f.sp = context;
}

static void change(void** from, void* to) {
    if (!*from) *from = new ucontext_t;
    swapcontext(static_cast<ucontext_t*>(*from), static_cast<ucontext_t*>(to));
}
#endif

void start_fiber(Fiber& f) {
    if (!f.stack) f.stack = static_cast<char*>(std::aligned_alloc(64, STACK_BYTES));
    prepare(f);
    f.state = READY;
    f.count = uint32_t(m.step) << 20;  // unique among the passes of a frame
    f.repeats = f.floor = 0;
    f.last_site = -1;
    f.inside = f.left = false;
    f.event = 0;
    f.pending.clear();
    f.epoch = ++m.epoch;
    f.out = Outputs();
    f.place = int(m.ready.size());
    m.ready.push_back(f.id);
    ++m.live;
}

void switch_to(Fiber* next) {
    Fiber* before = m.current;
    m.current = next;
    change(before ? &before->sp : &m.home, next ? next->sp : m.home);
}

void fail(const char* what, int site, uint64_t value) {
    if (!m.failure) {
        m.failure = what;
        m.failed_fiber = m.current ? m.current->id : -1;
        m.failed_site = site;
        m.failed_value = value;
    }
    switch_to(nullptr);  // nobody comes back here: the next frame starts every fiber anew
    std::abort();
}

static void leave_ready(Fiber& f) {
    if (f.place < 0) return;
    m.ready[size_t(f.place)] = m.ready.back();
    m.fibers[size_t(m.ready.back())].place = f.place;
    m.ready.pop_back();
    f.place = -1;
}

static void join_ready(Fiber& f) {
    f.state = READY;
    f.place = int(m.ready.size());
    m.ready.push_back(f.id);
}

void wake(uint32_t address) {
    for (int i = 0; i < m.used; ++i) {
        Fiber& f = m.fibers[size_t(i)];
        if (f.state != WAITING || f.awaits != address) continue;
        --m.waiting;
        f.repeats = 0;
        join_ready(f);
    }
}

// An access that changed nothing and gave what it gave the time before: the invocation waits for the word to change.
void spinning(int site, uint32_t address, uint32_t value) {
    Fiber& f = *m.current;
    bool again = f.last_site == site && f.last_address == address && f.last_value == value;
    f.repeats = again ? f.repeats + 1 : 0;
    f.last_site = site;
    f.last_address = address;
    f.last_value = value;
    if (f.repeats < WAITS) return;
    if (m.solo && f.repeats > 1000) fail("stuck", site, address);
    if (m.solo || lockstep_on) return;
    f.state = WAITING;
    f.awaits = address;
    ++m.waiting;
    pause_current();
}

static int lowest_ready() {
    int lowest = m.ready[0];
    for (int id : m.ready) lowest = id < lowest ? id : lowest;
    return lowest;
}

// The one of those ready, in the order of their numbers, `rank` behind the lowest; the current one left out.
static int ready_by_rank(int rank, int without) {
    for (int id = 0; id < m.used; ++id)
        if (m.fibers[size_t(id)].place >= 0 && id != without && rank-- == 0) return id;
    return lowest_ready();
}

static int most_urgent() {
    int best = m.ready[0];
    for (int id : m.ready)
        if (m.fibers[size_t(id)].priority > m.fibers[size_t(best)].priority) best = id;
    return best;
}

int exhaust(int kind, int alternatives);

// A choice is known by the invocation and its number of accesses, or, outside any, by its number.
struct Key { int fiber; uint32_t count; };

static Key key() {
    if (lockstep_on) return {-1, m.lockstep_choices};
    return m.current ? Key{m.current->id, m.current->count} : Key{-1, uint32_t(m.step)};
}

static void note(int kind, int value) {
    if (value) m.deviations.push_back({key().fiber, key().count, kind, value});
}

static int told(int kind) {
    Key at = key();
    for (auto& d : m.replayed)
        if (d.fiber == at.fiber && d.count == at.count && d.kind == kind) return d.value;
    return 0;
}

int choose(Choosing kind, int alternatives) {
    if (m.solo) return 0;
    int value = 0;
    switch (m.options.mode) {
        case REPLAY: value = told(kind); break;
        case EXHAUSTIVE: value = exhaust(kind, alternatives); break;
        case SEQUENTIAL: break;
        default:
            if (kind == DRAIN || kind == STALE) value = m.random.below(4) ? 0 : int(m.random.below(uint32_t(alternatives)));
            else if (kind == REVERSE) value = m.random.below(4) == 0;
            else value = int(m.random.below(uint32_t(alternatives)));
    }
    if (value >= alternatives) value = alternatives - 1;
    note(kind, value);
    if (lockstep_on) ++m.lockstep_choices;
    return value;
}

static bool by_priority() { return m.options.mode == PRIORITY && m.used <= MOST_WITH_PRIORITY; }

// Another that is ready, as the number that is noted of it: 1 more than its own. 0: whoever goes on by default.
static int other_ready(Choosing kind, int without, int others) {
    if (m.options.mode == EXHAUSTIVE) {
        int rank = exhaust(kind, others + (kind == SWITCH));
        return rank == 0 ? 0 : 1 + ready_by_rank(kind == SWITCH ? rank - 1 : rank, without);
    }
    if (m.options.mode == REPLAY) {
        int id = told(kind) - 1;
        return id >= 0 && id < m.used && m.fibers[size_t(id)].place >= 0 ? 1 + id : 0;
    }
    int id;
    do id = m.ready[m.random.below(uint32_t(m.ready.size()))];
    while (id == without);
    return 1 + id;
}

static Fiber* preempted_by() {
    Fiber& f = *m.current;
    int others = int(m.ready.size()) - 1, value = 0;
    if (others <= 0) return &f;
    if (by_priority()) {
        for (size_t i = 0; i < m.change_points.size(); ++i)
            if (m.change_points[i] == m.steps) f.priority = -1 - int(i);
        int best = most_urgent();
        value = best == f.id ? 0 : 1 + best;
    } else if (m.options.mode == EXHAUSTIVE || m.options.mode == REPLAY || m.random.next() < m.switch_chance) {
        value = other_ready(SWITCH, f.id, others);
    }
    note(SWITCH, value);
    return value ? &m.fibers[size_t(value - 1)] : &f;
}

void point() {
    Fiber& f = *m.current;
    ++f.count;
    if (++m.steps > MOST_STEPS) fail("endless", -1, 0);
    if (m.solo) return;
    if (lockstep_on) {
        switch_to(nullptr);
        return;
    }
    if (m.options.weak) drain_some();
    Fiber* next = preempted_by();
    if (next != &f) switch_to(next);
}

static Fiber* next_ready() {
    if (m.solo) return &m.fibers[size_t(m.ready.back())];
    int value = by_priority() ? 1 + most_urgent() : m.ready.size() > 1 ? other_ready(NEXT, -1, int(m.ready.size())) : 0;
    if (m.ready.size() > 1) note(NEXT, value);
    return value ? &m.fibers[size_t(value - 1)] : &m.fibers[size_t(lowest_ready())];
}

static bool everyone_at_barrier() {
    bool any = false;
    for (int i = 0; i < m.used; ++i) any = any || m.fibers[size_t(i)].state == AT_BARRIER;
    return any;
}

static void release_barrier(int group) {
    for (int i = 0; i < m.used; ++i) {
        Fiber& f = m.fibers[size_t(i)];
        if (f.state == AT_BARRIER && (group < 0 || f.group == group)) join_ready(f);
    }
}

// Everyone waits: those who wait for a word look again, some rounds long.
static void look_again() {
    if (++m.stuck_rounds > STUCK || !m.waiting) fail(everyone_at_barrier() ? "barrier" : "stuck", m.current->last_site, m.current->last_address);
    for (int i = 0; i < m.used; ++i) {
        Fiber& f = m.fibers[size_t(i)];
        if (f.state != WAITING) continue;
        --m.waiting;
        f.repeats = 0;
        join_ready(f);
    }
}

void pause_current() {
    Fiber& f = *m.current;
    leave_ready(f);
    if (m.solo || lockstep_on || !m.live) {
        switch_to(nullptr);
        return;
    }
    if (m.ready.empty()) look_again();
    Fiber* next = next_ready();
    if (next != &f) switch_to(next);
}

void work_barrier(int site) {
    Fiber& f = *m.current;
    log(BARRIER, site, "", 0, 0, 0);
    ++f.count;
    f.last_site = -1;
    f.state = AT_BARRIER;
    leave_ready(f);
    if (++m.at_barrier[size_t(f.group)] == m.pass->local_x * m.pass->local_y) {
        m.at_barrier[size_t(f.group)] = 0;
        release_barrier(f.group);
    }
    if (m.ready.empty()) look_again();
    Fiber* next = next_ready();
    if (next != &f) switch_to(next);
}

static bool may_enter(const Fiber& f) {
    for (int i = 0; i < m.used; ++i) {
        const Fiber& other = m.fibers[size_t(i)];
        bool alike = other.in.x == f.in.x && other.in.y == f.in.y && &other != &f;
        bool first = (m.options.ordered || m.pass->ordered) && other.id < f.id && other.state != DONE && !other.left;
        if (alike && (other.inside || first)) return false;
    }
    return true;
}

constexpr uint32_t GATE_ADDRESS = 0xFFFFFFF0u;  // of no word: the interlock

void interlock_begin(int site) {
    Fiber& f = *m.current;
    point();
    if (f.in.helper || m.solo) return;
    while (!may_enter(f)) {
        f.last_site = -1;
        f.state = WAITING;
        f.awaits = GATE_ADDRESS;
        ++m.waiting;
        pause_current();
    }
    f.inside = true;
    f.floor = m.clock;
    log(BEGIN, site, "", 0, 0, 0);
}

void interlock_end(int site) {
    Fiber& f = *m.current;
    point();
    if (f.in.helper || m.solo) return;
    f.inside = false;
    f.left = true;
    log(END, site, "", 0, 0, 0);
    if (m.waiting) wake(GATE_ADDRESS);
}

static void run_in_order() {
    for (int id : m.order) {
        if (m.failure) return;
        if (m.fibers[size_t(id)].state == READY) switch_to(&m.fibers[size_t(id)]);
    }
    while (m.live > 0 && !m.failure && !m.ready.empty()) switch_to(&m.fibers[size_t(lowest_ready())]);
    if (m.live > 0 && !m.failure) m.failure = "barrier";
}

static bool of_one_pixel(const Fiber& a, const Fiber& b) { return a.in.x == b.in.x && a.in.y == b.in.y; }

static void start_next_of_pixel(const Fiber& f) {
    for (int id = f.id + 1; id < m.used && !m.solo; ++id)
        if (of_one_pixel(f, m.fibers[size_t(id)])) return join_ready(m.fibers[size_t(id)]);
}

// Where a shader reads what the fragment before has left, the fragments of a pixel come one by one, in order of
// submission, and those of others meanwhile. Nobody else has the words of a pixel, so that a switch between a fragment's
// accesses to them would show nothing.
static void hold_pixels() {
    for (int id = 0; id < m.used; ++id)
        for (int before = 0; before < id; ++before)
            if (of_one_pixel(m.fibers[size_t(before)], m.fibers[size_t(id)])) {
                leave_ready(m.fibers[size_t(id)]);
                break;
            }
}

// Only so many fragments start; with each that ends the next one does, in order of submission.
static void hold_back() {
    if (m.pass->fetches) {
        m.held = m.used;
        if (!m.solo) hold_pixels();
        return;
    }
    bool limited = m.options.in_flight && m.pass->kind == GEOMETRY && !m.solo && !lockstep_on;
    m.held = limited && m.options.in_flight < m.used ? m.options.in_flight : m.used;
    for (int id = m.held; id < m.used; ++id) leave_ready(m.fibers[size_t(id)]);
}

void run_fibers() {
    m.stuck_rounds = 0;
    hold_back();
    if (m.solo) run_in_order();
    else if (lockstep_on) run_lockstep();
    else if (m.live > 0) switch_to(next_ready());
}
}  // namespace race
