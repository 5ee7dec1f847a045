// Accesses to memory. Strong: each takes effect at once. Weak: docs/races.md.
#include "machine.hpp"

namespace race {
constexpr size_t MOST_ON_THE_WAY = 16;  // stores of an invocation that have not reached memory
Machine m;

Inputs& inputs() { return m.current->in; }
Outputs& outputs() { return m.current->out; }
uint32_t uniform(Uniform which) { return m.uniforms[which]; }
glsl::V4<float> base_colour(int which) {
    const float* c = m.base[which];
    return {c[0], c[1], c[2], c[3]};
}
Uint block_length(int slot, int words) { return Uint(m.bound[slot].words / uint32_t(words)); }

static const char* name_of(int slot) {
    return slot >= SHARED_SLOT ? "shared memory" : m.pass->bindings[slot].name;
}

void log(Op op, int site, const char* buffer, uint32_t word, uint32_t before, uint32_t after, bool stale) {
    if (m.options.trace) m.events.push_back({m.current ? m.current->id : -1, site, uint8_t(op), buffer, word, before, after, stale});
}

static Bound bound_of(int slot) {
    Bound b = m.bound[slot];
    if (slot >= SHARED_SLOT) b.first += uint32_t(m.current->group) * m.pass->shared_words;
    return b;
}

static std::vector<uint32_t>& store_of(int slot) { return slot >= SHARED_SLOT ? m.shared : m.memory; }

static bool dropped(const Bound& b, Uint at) { return m.options.robust && at.v >= b.words; }

static uint32_t checked(const Bound& b, Uint at, int site, bool writes) {
    if (at.v >= b.words) fail(writes ? "out_of_bounds_write" : "out_of_bounds_read", site, at.v);
    return b.first + at.v;
}

// ---- weak memory: versions of a word in the order in which they reached memory

static void new_version(uint32_t address, uint32_t value) {
    auto& versions = m.history[address];
    if (versions.empty()) {
        versions.push_back({0, m.memory[address]});
        m.touched.push_back(address);
    }
    versions.push_back({++m.clock, value});
    m.memory[address] = value;
}

static void write_now(int slot, uint32_t address, uint32_t value) {
    auto& words = store_of(slot);
    uint32_t before = words[address];
    if (m.options.weak && slot < SHARED_SLOT && !m.solo) new_version(address, value);
    else words[address] = value;
    if (before != value) m.last_change = m.steps;
    if (m.waiting && before != value) wake(address);
}

static uint32_t& seen_at(Fiber& f, uint32_t address) {
    if (f.seen.empty()) f.seen.resize(m.memory.size());
    Seen& s = f.seen[address];
    if (s.epoch != f.epoch) s = {f.epoch, 0};
    return s.time;
}

void drain(Fiber& f, size_t entry) {
    Pending p = f.pending[entry];
    for (size_t i = 0; i < entry; ++i)  // what the same invocation stored there before goes first
        if (f.pending[i].address == p.address) {
            drain(f, i);
            return;
        }
    f.pending.erase(f.pending.begin() + long(entry));
    --m.on_the_way;
    uint32_t before = m.memory[p.address];
    write_now(0, p.address, p.value);
    seen_at(f, p.address) = m.clock;  // nobody loads what was there before a store of its own
    if (m.options.trace) {
        const char* buffer = "";
        uint32_t word = p.address;
        for (int slot = 0; slot < m.pass->binding_count; ++slot)
            if (p.address >= m.bound[slot].first && p.address < m.bound[slot].first + m.bound[slot].words) {
                buffer = name_of(slot);
                word = p.address - m.bound[slot].first;
            }
        m.events.push_back({f.id, p.site, REACH, buffer, word, before, p.value, false});
    }
}

// Now and then a store that is on its way reaches memory.
void drain_some() {
    if (!m.on_the_way) return;
    int which = choose(DRAIN, m.on_the_way + 1) - 1;
    for (int i = 0; which >= 0 && i < m.used; ++i) {
        int held = int(m.fibers[size_t(i)].pending.size());
        if (which < held) drain(m.fibers[size_t(i)], size_t(which));
        which -= held;
    }
}

void publish_all() {
    for (int i = 0; m.on_the_way && i < m.used; ++i)
        while (!m.fibers[size_t(i)].pending.empty()) drain(m.fibers[size_t(i)], 0);
    for (uint32_t address : m.touched) m.history[address].clear();
    m.touched.clear();
    m.clock = 0;
}

static Uint weak_load(Fiber& f, const Bound& b, uint32_t address, uint32_t depends, bool& stale) {
    for (size_t i = f.pending.size(); i-- > 0;)
        if (f.pending[i].address == address) return {f.pending[i].value, m.clock};
    uint32_t& seen = seen_at(f, address);
    uint32_t oldest = seen;
    if (b.coherent) oldest = glsl::later(oldest, glsl::later(f.floor, m.options.dependencies ? depends : 0));
    auto& versions = m.history[address];
    if (versions.empty()) return {m.memory[address], m.clock};
    int last = int(versions.size()) - 1, reach = 0;
    while (reach < last && versions[size_t(last - reach)].time > oldest) ++reach;
    int back = reach ? choose(STALE, reach + 1) : 0;
    if (!back) {
        seen = m.clock;
        return {versions[size_t(last)].value, m.clock};
    }
    stale = true;
    seen = versions[size_t(last - back + 1)].time - 1;  // just before the next version came
    return {versions[size_t(last - back)].value, seen};
}

// ---- the accesses

static Uint load_at(int slot, Uint at, int site) {
    point();
    Bound b = bound_of(slot);
    Fiber& f = *m.current;
    if (f.in.helper || dropped(b, at)) return Uint(0);
    uint32_t address = checked(b, at, site, false);
    bool stale = false;
    Uint value = m.options.weak && slot < SHARED_SLOT && !m.solo ? weak_load(f, b, address, at.since, stale)
                                                                 : Uint(store_of(slot)[address], m.clock);
    log(LOAD, site, name_of(slot), at.v, value.v, value.v, stale);
    if (!stale) spinning(site, address, value.v);
    return value;
}

static void store_at(int slot, Uint at, Uint value, int site) {
    point();
    Bound b = bound_of(slot);
    Fiber& f = *m.current;
    if (f.in.helper || dropped(b, at)) return;
    uint32_t address = checked(b, at, site, true);
    f.last_site = -1;
    log(STORE, site, name_of(slot), at.v, store_of(slot)[address], value.v);
    if (m.options.weak && slot < SHARED_SLOT && !m.solo) {
        f.pending.push_back({address, value.v, b.coherent, site});
        ++m.on_the_way;
        if (f.pending.size() > MOST_ON_THE_WAY) drain(f, 0);
        else if (!choose(DELAY, 2)) drain(f, f.pending.size() - 1);
    } else {
        write_now(slot, address, value.v);
    }
}

Uint load_word(int slot, Uint at, int site) { return load_at(slot, at, site); }
void store_word(int slot, Uint at, Uint value, int site) { store_at(slot, at, value, site); }

// The words of an element are accesses of their own, in any order.
void load_words(int slot, Uint first, int count, Uint* words, int site) {
    bool back = count > 1 && choose(REVERSE, 2);
    for (int i = 0; i < count; ++i) {
        int word = back ? count - 1 - i : i;
        words[word] = load_at(slot, first + Uint(word), site);
    }
}

void store_words(int slot, Uint first, int count, const Uint* words, int site) {
    bool back = count > 1 && choose(REVERSE, 2);
    for (int i = 0; i < count; ++i) {
        int word = back ? count - 1 - i : i;
        store_at(slot, first + Uint(word), words[word], site);
    }
}

template <class T> static T result_of(Op op, T old, T value, T compare) {
    switch (op) {
        case ADD: return old + value;
        case AND: return old & value;
        case OR: return old | value;
        case XOR: return old ^ value;
        case MIN: return value < old ? value : old;
        case MAX: return value > old ? value : old;
        case SWAP: return old == compare ? value : old;
        default: return value;
    }
}

static void drain_own(Fiber& f, uint32_t address) {
    for (size_t i = 0; i < f.pending.size();)
        if (f.pending[i].address == address) {
            drain(f, i);
            i = 0;
        } else {
            ++i;
        }
}

Uint atomic_word(Op op, int slot, Uint at, Uint value, Uint compare, int site) {
    point();
    Bound b = bound_of(slot);
    Fiber& f = *m.current;
    if (f.in.helper || dropped(b, at)) return Uint(0);
    uint32_t address = checked(b, at, site, true);
    drain_own(f, address);
    uint32_t old = store_of(slot)[address], now = result_of(op, old, value.v, compare.v);
    if (now != old) write_now(slot, address, now);
    if (m.options.weak && slot < SHARED_SLOT && !m.solo) seen_at(f, address) = m.clock;
    log(op, site, name_of(slot), at.v, old, now);
    if (now == old) spinning(site, address, old);
    else f.last_site = -1;
    return {old, m.clock};
}

U64 atomic_wide(Op op, int slot, Uint at, U64 value, U64 compare, int site) {
    point();
    Bound b = bound_of(slot);
    Fiber& f = *m.current;
    if (f.in.helper || dropped(b, at * Uint(2))) return U64(0);
    uint32_t low = checked(b, at * Uint(2), site, true), high = low + 1;
    drain_own(f, low);
    drain_own(f, high);
    uint64_t old = m.memory[low] | uint64_t(m.memory[high]) << 32, now = result_of(op, old, value.v, compare.v);
    if (uint32_t(now) != uint32_t(old)) write_now(slot, low, uint32_t(now));
    if (now >> 32 != old >> 32) write_now(slot, high, uint32_t(now >> 32));
    if (m.options.weak && !m.solo) seen_at(f, low) = seen_at(f, high) = m.clock;
    log(op, site, name_of(slot), at.v * 2, uint32_t(old), uint32_t(now));
    log(op, site, name_of(slot), at.v * 2 + 1, uint32_t(old >> 32), uint32_t(now >> 32));
    if (now == old) spinning(site, low, uint32_t(old));
    else f.last_site = -1;
    return {old, m.clock};
}

void memory_barrier(int site) {
    Fiber& f = *m.current;
    if (m.options.trace) log(FENCE, site, "", 0, 0, 0);
    if (!m.options.weak || m.solo || f.in.helper) return;
    auto waits = [&f] {
        for (size_t i = 0; i < f.pending.size(); ++i)
            if (f.pending[i].coherent) return long(i);
        return -1L;
    };
    for (long i; (i = waits()) >= 0;) {
        point();
        if ((i = waits()) >= 0) drain(f, size_t(i));
    }
    f.floor = m.clock;
}
}  // namespace race
