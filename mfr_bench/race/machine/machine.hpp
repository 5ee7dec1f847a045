// What generated shaders call, and what the parts of the machine share.
#pragma once
#include "glsl.hpp"
#include <vector>

namespace race {
using glsl::Uint;
using glsl::U64;

// What the translator says of a frame. All tables are constants of the generated file.
struct BufferDesc { const char* name; uint32_t words; int copies; };
struct BindingDesc { const char* name; int buffer; int role; bool coherent; };  // role 0: as it is, 1: current, 2: previous
struct TextureDesc { int target; int role; };
struct OutputDesc { int target; int role; int layers; int location; bool clears; float clear[4]; bool keeps; };
struct TargetDesc { const char* name; int format; int copies, samples, layers; bool depth, integer; };
struct BlendDesc { int equation, source, destination, source_alpha, destination_alpha; };  // equation 0: none
enum Kind { GEOMETRY, FULLSCREEN, COMPUTE, CLEAR };
struct PassDesc {
    const char* name;
    int kind;
    void (*run)();
    const BindingDesc* bindings; int binding_count;
    const TextureDesc* textures; int texture_count;
    const OutputDesc* outputs; int output_count;
    BlendDesc blends[8]; int blend_count;
    int depth_test;  // 0 none, 1 less, 2 lequal, 3 equal, 4 always
    bool depth_write, early, writes_depth, samples_all;
    int stencil_test, stencil_update, stencil_reference;  // test 0 none, 1 always, 2 equal; update 1 up, 2 down
    bool region, corner, by_tile, concurrent, counts, sets_capacity, interlocked, ordered, uses_mask, fetches;
    int instances, groups, local_x, local_y, command, command_class;  // command: buffer of indirect draws, -1 none
    int written[16]; int written_count;  // slots that a clear by the driver zeroes
    uint32_t shared_words;
};
struct StepDesc { int pass, iteration, leave; };  // leave: step to go on with where the counting pass sees none, or -1
struct FrameDesc {
    const BufferDesc* buffers; int buffer_count;
    const TargetDesc* targets; int target_count;
    const PassDesc* passes; int pass_count;
    const StepDesc* steps; int step_count; int first_frame_steps;
    uint32_t width, height, capacity, chosen_k;
    int diagnostics, grown_counter, image, tile_list, tile_command;  // buffers, and the target that holds the image
    uint32_t region[4];  // left, bottom, width, height
};
extern const FrameDesc frame;

// ---- what shaders call

enum Op { LOAD, STORE, ADD, AND, OR, XOR, MIN, MAX, EXCHANGE, SWAP, REACH, FENCE, BARRIER, BEGIN, END, DISCARD, GATE };
enum Uniform { WIDTH, HEIGHT, PIXELS, CAPACITY, SEED, KEEP_THRESHOLD, CHOSEN_K, REGION_FIRST, REGION_COLUMNS,
               REGION_PIXELS, REGION_LEFT, REGION_BOTTOM, REGION_RIGHT, REGION_TOP, BOX_NEAR, BOX_FAR,
               ITERATION, UNIFORMS };
struct Inputs {  // of the running invocation
    uint32_t x = 0, y = 0, quad = 0, payload = 0, instance = 0;
    float z = 0.0f;
    bool helper = false;
    uint32_t group = 0, groups = 1, local_x = 0, local_y = 0, local_index = 0;
};
struct Outputs {
    bool discarded = false, has_depth = false;
    uint32_t colour[16][4] = {};
    float depth = 0.0f;
    uint32_t mask = 0xFFFFFFFFu;
};
Inputs& inputs();
Outputs& outputs();
uint32_t uniform(Uniform which);
glsl::V4<float> base_colour(int which);
Uint block_length(int slot, int words);

Uint load_word(int slot, Uint at, int site);
void store_word(int slot, Uint at, Uint value, int site);
void load_words(int slot, Uint first, int count, Uint* words, int site);
void store_words(int slot, Uint first, int count, const Uint* words, int site);
Uint atomic_word(Op op, int slot, Uint at, Uint value, Uint compare, int site);
U64 atomic_wide(Op op, int slot, Uint at, U64 value, U64 compare, int site);
void memory_barrier(int site);
void work_barrier(int site);
void interlock_begin(int site);
void interlock_end(int site);
glsl::V4<float> fetch_float(int unit, int x, int y, int layer, int sample);
glsl::V4<Uint> fetch_uint(int unit, int x, int y, int layer, int sample);
void store_image(int location, int x, int y, glsl::V4<float> colour);
glsl::V4<float> fetched_float(int location);      // of the running invocation's pixel, as the one before has left it
glsl::V4<Uint> fetched_uint(int location);

template <class P> void put_output(int location, const glsl::V4<P>& value) {
    const P parts[4] = {value.x, value.y, value.z, value.w};
    for (int i = 0; i < 4; ++i) {
        Uint word;
        if constexpr (std::is_same_v<P, float>) word = Uint(glsl::bits(parts[i])); else word = glsl::Cast<Uint, P>::of(parts[i]);
        outputs().colour[location][i] = word.v;
    }
}
inline void put_texel(int location, glsl::V2<int> at, glsl::V4<float> colour) { store_image(location, at.x, at.y, colour); }
inline glsl::V4<float> texel_float(int unit, glsl::V2<int> at, int sample) { return fetch_float(unit, at.x, at.y, 0, sample); }
inline glsl::V4<float> texel_float(int unit, glsl::V3<int> at, int sample) { return fetch_float(unit, at.x, at.y, at.z, sample); }
inline glsl::V4<Uint> texel_uint(int unit, glsl::V2<int> at, int sample) { return fetch_uint(unit, at.x, at.y, 0, sample); }
inline glsl::V4<Uint> texel_uint(int unit, glsl::V3<int> at, int sample) { return fetch_uint(unit, at.x, at.y, at.z, sample); }
template <class T, class V> T& assign(T& to, const V& value) {
    if constexpr (std::is_convertible_v<V, T>) return to = value; else return to = glsl::make<T>(value);
}

extern bool lockstep_on;
bool lockstep_branch(bool condition, int id, bool returns);
void lockstep_join(int id);
inline bool branch(bool condition, int id, bool returns = false) {
    return lockstep_on ? lockstep_branch(condition, id, returns) : condition;
}
struct Join {
    int id;
    ~Join() { if (lockstep_on) lockstep_join(id); }
};

// Elements of several words, in the order of their members.
template <class T> struct Words;
template <> struct Words<Uint> { static constexpr int count = 1;
    static Uint from(const Uint* w) { return w[0]; } static void to(Uint* w, Uint a) { w[0] = a; } };
template <> struct Words<float> { static constexpr int count = 1;
    static float from(const Uint* w) { return glsl::from_bits(w[0].v); }
    static void to(Uint* w, float a) { w[0] = Uint(glsl::bits(a)); } };
template <> struct Words<int> { static constexpr int count = 1;
    static int from(const Uint* w) { return int(w[0].v); } static void to(Uint* w, int a) { w[0] = Uint(a); } };
template <> struct Words<U64> { static constexpr int count = 2;
    static U64 from(const Uint* w) { return {w[0].v | uint64_t(w[1].v) << 32, glsl::later(w[0].since, w[1].since)}; }
    static void to(Uint* w, U64 a) { w[0] = {uint32_t(a.v), a.since}; w[1] = {uint32_t(a.v >> 32), a.since}; } };
#define VECTOR_WORDS(V, N) template <class P> struct Words<glsl::V<P>> { static constexpr int count = N; \
    static glsl::V<P> from(const Uint* w) { glsl::V<P> r; for (int i = 0; i < N; ++i) (&r.x)[i] = Words<P>::from(w + i); return r; } \
    static void to(Uint* w, const glsl::V<P>& a) { for (int i = 0; i < N; ++i) Words<P>::to(w + i, (&a.x)[i]); } };
VECTOR_WORDS(V2, 2) VECTOR_WORDS(V3, 3) VECTOR_WORDS(V4, 4)
#undef VECTOR_WORDS

template <class T> T load(int slot, Uint at, int site) {
    Uint words[Words<T>::count];
    load_words(slot, at * Uint(Words<T>::count), Words<T>::count, words, site);
    return Words<T>::from(words);
}
template <class T> T store(int slot, Uint at, const T& value, int site) {
    Uint words[Words<T>::count];
    Words<T>::to(words, value);
    store_words(slot, at * Uint(Words<T>::count), Words<T>::count, words, site);
    return value;
}
// One word of an element.
template <class T, class P> P load_part(int slot, Uint at, int part, int site) {
    Uint word = load_word(slot, at * Uint(Words<T>::count) + Uint(part), site);
    return Words<P>::from(&word);
}
template <class T, class P> P store_part(int slot, Uint at, int part, P value, int site) {
    Uint word;
    Words<P>::to(&word, value);
    store_word(slot, at * Uint(Words<T>::count) + Uint(part), word, site);
    return value;
}
inline Uint atomic(Op op, int slot, Uint at, Uint value, int site) { return atomic_word(op, slot, at, value, Uint(), site); }
inline Uint atomic(Op op, int slot, Uint at, Uint compare, Uint value, int site) { return atomic_word(op, slot, at, value, compare, site); }
inline U64 atomic(Op op, int slot, Uint at, U64 value, int site) { return atomic_wide(op, slot, at, value, U64(), site); }
inline U64 atomic(Op op, int slot, Uint at, U64 compare, U64 value, int site) { return atomic_wide(op, slot, at, value, compare, site); }

// ---- what the parts of the machine share

constexpr int SHARED_SLOT = 16;  // slots from here on are memory of a work group
enum State : uint8_t { READY, WAITING, AT_BARRIER, DONE };
enum Choosing : uint8_t { SWITCH, NEXT, DELAY, DRAIN, STALE, REVERSE, SIDE };
struct Deviation { int fiber; uint32_t count; int kind; int value; };
struct Pending { uint32_t address; uint32_t value; bool coherent; int site; };
struct Seen { uint32_t epoch, time; };  // of another epoch: not yet seen
struct Fiber {
    void* sp = nullptr;
    char* stack = nullptr;
    int id = 0, group = 0, place = -1;  // place among those that are ready
    State state = DONE;
    Inputs in;
    Outputs out;
    uint32_t count = 0;           // accesses so far: the key of a choice
    int last_site = -1;           // of the access before, to find out a wait
    uint32_t last_address = 0, last_value = 0, repeats = 0, awaits = 0;
    bool inside = false, left = false;  // the interlock
    int event = 0, event_id = 0;  // of lockstep: what the lane has come to
    bool condition = false, returns = false;
    uint32_t floor = 0;           // the time of its last barrier: no load is older
    std::vector<Pending> pending;
    std::vector<Seen> seen;       // per word; weak memory only
    uint32_t epoch = 0;
    int priority = 0;
};
struct Bound { uint32_t first, words; bool coherent; };
struct Event { int fiber, site; uint8_t op; const char* buffer; uint32_t word, before, after; bool stale; };

enum Mode { RANDOM, PRIORITY, EXHAUSTIVE, REPLAY, SEQUENTIAL };
struct Options {
    Mode mode = RANDOM;
    bool weak = false, dependencies = true, trace = false, ordered = false, late = false, one_failure = true, may_lose = false;
    bool robust = false;                          // out of bounds a load gives 0 and a store is dropped
    int warp = 0, bound = 2, in_flight = 0;       // the last: fragments of a geometry pass at a time, 0 for all
    uint64_t seed = 1, schedules = 1000;
};

struct Random {
    uint64_t s;
    explicit Random(uint64_t seed) : s(mixed(mixed(seed + 1))) { s += s == 0; }
    static uint64_t mixed(uint64_t a) {  // splitmix64: seeds side by side give sequences that have nothing in common
        a += 0x9E3779B97F4A7C15ull;
        a = (a ^ a >> 30) * 0xBF58476D1CE4E5B9ull;
        a = (a ^ a >> 27) * 0x94D049BB133111EBull;
        return a ^ a >> 31;
    }
    uint32_t next() {
        s ^= s << 13; s ^= s >> 7; s ^= s << 17;
        return uint32_t(s * 0x2545F4914F6CDD1Dull >> 32);
    }
    uint32_t below(uint32_t n) { return uint32_t(uint64_t(next()) * n >> 32); }
};

struct Version { uint32_t time, value; };
struct Fragment { uint32_t x, y, depth, rgba, quad; bool helper; };

struct Machine {
    Options options;
    Random random{1};
    std::vector<uint32_t> memory, poison;
    std::vector<uint32_t> first;                  // of each buffer and copy
    std::vector<std::vector<Version>> history;    // per word, of this pass; weak memory only
    std::vector<uint32_t> touched;                // words with a history
    std::vector<std::vector<uint32_t>> texels;    // per target: copies, layers, samples, pixels, four words
    std::vector<uint8_t> stencil;
    std::vector<Fragment> fragments;
    std::vector<std::vector<float>> allowed;      // images
    Bound bound[SHARED_SLOT + 8];
    std::vector<uint32_t> shared;                 // memory of the running work groups
    uint32_t uniforms[UNIFORMS] = {};
    float base[2][4] = {};

    std::vector<Fiber> fibers;
    std::vector<int> ready, at_barrier;           // the latter: how many of each work group
    int live = 0, used = 0;                       // fibers not done; fibers of this pass
    int held = 0;                                 // the first fiber that may not start yet
    Fiber* current = nullptr;
    void* home = nullptr;                         // the stack of the machine itself
    const PassDesc* pass = nullptr;
    int pass_index = 0, iteration = 0, step = 0;
    bool solo = false;
    uint32_t clock = 0, waiting = 0, stuck_rounds = 0, epoch = 0;
    int on_the_way = 0;                           // stores of this pass that have not reached memory
    uint64_t steps = 0, last_change = 0;
    uint32_t lockstep_choices = 0;
    std::vector<int> order;                       // of the fibers of a pass that run one after the other
    uint32_t switch_chance = 0;
    std::vector<uint32_t> change_points;
    std::vector<Deviation> deviations, replayed;
    std::vector<Event> events;
    const char* failure = nullptr;
    int failed_fiber = -1, failed_site = -1;
    uint64_t failed_value = 0;
};
extern Machine m;

int choose(Choosing kind, int alternatives);      // of the current fiber; 0 is what happens by default
void point();                                     // before each access: who goes on
void pause_current();                             // the current fiber cannot go on
void wake(uint32_t address);
void spinning(int site, uint32_t address, uint32_t value);
void log(Op op, int site, const char* buffer, uint32_t word, uint32_t before, uint32_t after, bool stale = false);
[[noreturn]] void fail(const char* what, int site, uint64_t value);
void publish_all();                               // at the end of a pass
void drain_some();
void drain(Fiber& f, size_t entry);
void start_fiber(Fiber& f);
void switch_to(Fiber* next);                      // nullptr: the machine itself
void run_fibers();
void raster_now(const Fiber& f);                  // what follows its shader, before another of its pixel starts
void run_lockstep();
bool draw_frame();                                // false where something failed
void exhaust_begin();
bool exhaust_next();                              // whether a schedule is left
}  // namespace race

using namespace glsl;
using race::Join;
using race::assign;
using race::branch;
