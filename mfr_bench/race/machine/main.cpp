// The program: reads what to do from its arguments and standard input, prints one JSON object.
#include "machine.hpp"
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>

namespace glsl {
void local_array_overrun(int64_t index, int, int line) { race::fail("local_array_overrun", line, uint64_t(index)); }

uint32_t half_bits(float a) {
    uint32_t f = bits(a), sign = f >> 16 & 0x8000u, e = f >> 23 & 255u, fraction = f & 0x7FFFFFu;
    if (e == 255) return sign | 0x7C00u | (fraction ? 0x200u : 0u);
    int exponent = int(e) - 112;
    if (exponent >= 31) return sign | 0x7C00u;
    uint32_t whole, rest, half;
    if (exponent <= 0) {
        if (exponent < -10) return sign;
        uint32_t shift = uint32_t(14 - exponent);
        fraction |= 0x800000u;
        whole = fraction >> shift, rest = fraction & ((1u << shift) - 1), half = 1u << (shift - 1);
    } else {
        whole = uint32_t(exponent) << 10 | fraction >> 13, rest = fraction & 0x1FFFu, half = 0x1000u;
    }
    return sign | (whole + (rest > half || (rest == half && (whole & 1u))));
}

float half_value(uint32_t h) {
    uint32_t e = h >> 10 & 31u, fraction = h & 0x3FFu;
    float value = e == 31 ? (fraction ? NAN : INFINITY) : e ? std::ldexp(float(fraction | 0x400u), int(e) - 25)
                                                              : std::ldexp(float(fraction), -24);
    return h & 0x8000u ? -value : value;
}
}  // namespace glsl

namespace race {
namespace {
constexpr float TOLERANCE = 4e-6f;  // of a channel: float32 sums in another order
constexpr int MOST_IMAGES = 4096;
constexpr uint32_t REFERENCE_FRAMES = 2000;
constexpr uint64_t REFERENCE_STEPS = 2'000'000;  // accesses of all these frames, at most
uint64_t lost_frames, wrong_frames, failed_frames;

std::vector<float> image() {
    const auto& texels = m.texels[size_t(frame.image)];
    std::vector<float> colours(size_t(frame.width) * frame.height * 4);
    for (size_t i = 0; i < colours.size(); ++i) colours[i] = glsl::from_bits(texels[i]);
    return colours;
}

uint32_t lost() { return m.memory[m.first[size_t(frame.diagnostics)]]; }

// Each pixel has one of the colours that it may have.
bool pixel_allowed(const std::vector<float>& found, size_t pixel) {
    for (const auto& one : m.allowed) {
        bool alike = true;
        for (size_t c = 4 * pixel; c < 4 * pixel + 4; ++c) alike = alike && std::fabs(one[c] - found[c]) <= TOLERANCE;
        if (alike) return true;
    }
    return false;
}

std::vector<float> low_bound, high_bound;  // of a promise by bounds

bool image_right() {
    const auto& texels = m.texels[size_t(frame.image)];
    if (!low_bound.empty()) {
        for (size_t i = 0; i < low_bound.size(); ++i) {
            float v = glsl::from_bits(texels[i]);
            if (!(v >= low_bound[i] && v <= high_bound[i])) return false;
        }
        return true;
    }
    if (m.allowed.empty()) return true;
    const auto& one = m.allowed[0];
    bool first = true;
    for (size_t i = 0; first && i < one.size(); ++i) first = std::fabs(one[i] - glsl::from_bits(texels[i])) <= TOLERANCE;
    if (first) return true;
    std::vector<float> found = image();
    for (size_t pixel = 0; pixel < found.size() / 4; ++pixel)
        if (!pixel_allowed(found, pixel)) return false;
    return true;
}

// What is wrong with the frame just drawn, or nullptr.
const char* judged() {
    if (m.failure) return m.failure;
    if (frame.grown_counter >= 0 && m.memory[m.first[size_t(frame.grown_counter)]] > frame.capacity) return "grown";
    if (lost()) return m.options.may_lose ? nullptr : "lost_fragments";
    return image_right() ? nullptr : "wrong_image";
}

void print_floats(const std::vector<float>& values) {
    std::printf("[");
    for (size_t i = 0; i < values.size(); ++i) std::printf("%s%.9g", i ? ", " : "", double(values[i]));
    std::printf("]");
}

void print_events() {
    static const char* const NAMES[] = {"load", "store", "atomicAdd", "atomicAnd", "atomicOr", "atomicXor", "atomicMin",
        "atomicMax", "atomicExchange", "atomicCompSwap", "reaches_memory", "memoryBarrierBuffer", "barrier",
        "interlock_begin", "interlock_end", "discard", "gate"};
    std::printf("\"events\": [");
    bool first = true;
    for (const Event& e : m.events) {
        std::printf("%s\n  [%d, %d, \"%s\", \"%s\", %u, %u, %u, %s]", first ? "" : ",", e.fiber, e.site, NAMES[e.op], e.buffer,
                    e.word, e.before, e.after, e.stale ? "true" : "false");
        first = false;
    }
    std::printf("], ");
}

void print_failure(const char* what) {
    std::printf("\"failure\": \"%s\", \"fiber\": %d, \"site\": %d, \"value\": %llu, \"lost\": %u, \"image\": ", what, m.failed_fiber,
                m.failed_site, static_cast<unsigned long long>(m.failed_value), m.failure ? 0u : lost());
    print_floats(image());
    std::printf(", \"deviations\": [");
    for (size_t i = 0; i < m.deviations.size(); ++i) {
        const Deviation& d = m.deviations[i];
        std::printf("%s[%d, %u, %d, %d]", i ? ", " : "", d.fiber, d.count, d.kind, d.value);
    }
    std::printf("], ");
}

void begin_schedule(uint64_t index, uint64_t length) {
    m.random = Random(m.options.seed * 1000003ull + index);
    m.switch_chance = 0xFFFFFFFFu >> (1 + m.random.below(5));
    if (m.options.mode != PRIORITY) return;
    m.change_points.clear();
    for (uint32_t depth = m.random.below(4); depth > 0; --depth) m.change_points.push_back(1 + m.random.below(uint32_t(length)));
}

bool same_failure(const char* a, const std::string& b) { return a && b == a; }

// Leaves out choices one by one, and in halves, while the frame still fails alike: what is left is needed.
void shrink(const std::string& what) {
    std::vector<Deviation> kept = m.deviations;
    m.options.mode = REPLAY;
    auto fails_with = [&what](const std::vector<Deviation>& tried) {
        m.replayed = tried;
        draw_frame();
        return same_failure(judged(), what);
    };
    if (fails_with(kept)) {
        for (size_t chunk = std::max<size_t>(1, kept.size() / 2); chunk >= 1; chunk /= 2) {
            for (size_t from = 0; from < kept.size();) {
                std::vector<Deviation> tried = kept;
                tried.erase(tried.begin() + long(from), tried.begin() + long(std::min(tried.size(), from + chunk)));
                if (fails_with(tried)) kept = m.deviations.size() < tried.size() ? m.deviations : tried;
                else from += chunk;
            }
            if (chunk == 1) break;
        }
    }
    m.replayed = kept;
}

void show_failure(const std::string& what, bool shrunk) {
    if (shrunk) shrink(what);
    else m.replayed = m.deviations;
    m.options.mode = REPLAY;
    m.options.trace = true;
    draw_frame();
    const char* again = judged();
    print_failure(again ? again : what.c_str());
    print_events();
}

void count_failure(const char* what) {
    if (!what) return;
    ++failed_frames;
    if (std::string(what) == "lost_fragments") ++lost_frames;
    if (std::string(what) == "wrong_image") ++wrong_frames;
}

void check(bool shrunk) {
    std::clock_t began = std::clock();
    bool mixed = m.options.mode == RANDOM, exhaustive = m.options.mode == EXHAUSTIVE, left = true;
    uint64_t done = 0, length = 100;
    std::string failure;
    if (exhaustive) exhaust_begin();
    while (left && done < m.options.schedules) {
        if (mixed) m.options.mode = done % 2 && !m.options.warp ? PRIORITY : RANDOM;
        if (!exhaustive) begin_schedule(done, length);
        draw_frame();
        const char* what = judged();
        length = std::max<uint64_t>(10, m.steps);
        ++done;
        count_failure(what);
        if (what && m.options.one_failure) {
            failure = what;
            break;
        }
        left = !exhaustive || exhaust_next();
    }
    double seconds = double(std::clock() - began) / CLOCKS_PER_SEC;
    std::printf("{\"schedules\": %llu, \"seconds\": %.6f, \"complete\": %s, \"failed\": %llu, \"lost_frames\": %llu, \"wrong\": %llu, ",
                static_cast<unsigned long long>(done), seconds, exhaustive && !left ? "true" : "false",
                static_cast<unsigned long long>(failed_frames), static_cast<unsigned long long>(lost_frames),
                static_cast<unsigned long long>(wrong_frames));
    if (!failure.empty()) show_failure(failure, shrunk);
    std::printf("\"steps\": %llu}\n", static_cast<unsigned long long>(length));
}

// The images of frames whose fragments come one after the other, in many orders.
void reference() {
    m.options.mode = SEQUENTIAL;
    std::printf("{\"images\": [");
    const char* what = nullptr;
    uint64_t lost_in_order = 0, steps = 0;
    for (uint32_t i = 0; i < REFERENCE_FRAMES && steps < REFERENCE_STEPS; ++i) {
        m.random = Random(i + 1);
        draw_frame();
        steps += m.steps;
        what = m.failure;
        if (what) break;
        lost_in_order += lost() > 0;
        std::vector<float> found = image();
        bool known = false;
        for (const auto& one : m.allowed) known = known || one == found;
        if (known || m.allowed.size() >= MOST_IMAGES) continue;
        if (!m.allowed.empty()) std::printf(", ");
        print_floats(found);
        m.allowed.push_back(found);
    }
    std::printf("], \"lost_frames\": %llu, ", static_cast<unsigned long long>(lost_in_order));
    if (what) {
        m.options.trace = true;
        print_failure(what);
    }
    std::printf("\"steps\": %llu}\n", static_cast<unsigned long long>(m.steps));
}

void replay() {
    m.options.mode = REPLAY;
    m.options.trace = true;
    draw_frame();
    const char* what = judged();
    std::printf("{\"schedules\": 1, ");
    print_failure(what ? what : "");
    print_events();
    std::printf("\"steps\": %llu}\n", static_cast<unsigned long long>(m.steps));
}

void read_fragments() {
    unsigned count;
    if (std::scanf("%u", &count) != 1) std::exit(2);
    for (unsigned i = 0; i < count; ++i) {
        Fragment f{};
        unsigned helper;
        if (std::scanf("%u %u %u %u %u %u", &f.x, &f.y, &f.depth, &f.rgba, &f.quad, &helper) != 6) std::exit(2);
        f.helper = helper;
        m.fragments.push_back(f);
    }
}

void read_scene() {
    read_fragments();
    for (auto& base : m.base)
        for (float& part : base)
            if (std::scanf("%f", &part) != 1) std::exit(2);
}

void read_images(std::vector<std::vector<float>>& images) {
    unsigned count;
    if (std::scanf("%u", &count) != 1) std::exit(2);
    for (unsigned i = 0; i < count; ++i) {
        images.emplace_back(size_t(frame.width) * frame.height * 4);
        for (float& part : images.back())
            if (std::scanf("%f", &part) != 1) std::exit(2);
    }
}

void read_deviations() {
    Deviation d{};
    while (std::scanf("%d %u %d %d", &d.fiber, &d.count, &d.kind, &d.value) == 4) m.replayed.push_back(d);
}

void allocate() {
    uint32_t words = 0;
    for (int i = 0; i < frame.buffer_count; ++i) {
        m.first.push_back(words);
        words += frame.buffers[i].words * uint32_t(frame.buffers[i].copies);
    }
    m.poison.assign(words, 0xA5A5A5A5u);  // what nobody wrote is nobody's
    std::fill_n(&m.poison[m.first[size_t(frame.diagnostics)]], frame.buffers[frame.diagnostics].words, 0u);
    m.history.resize(words);
    for (int i = 0; i < frame.target_count; ++i) {
        const TargetDesc& t = frame.targets[i];
        m.texels.emplace_back(size_t(t.copies * t.layers * t.samples) * frame.width * frame.height * 4, 0u);
    }
    m.stencil.assign(size_t(64) * frame.width * frame.height, 0);
    size_t most = std::max<size_t>(m.fragments.size(), frame.width * frame.height);
    for (int i = 0; i < frame.pass_count; ++i) {
        const PassDesc& p = frame.passes[i];
        if (p.kind == COMPUTE) most = std::max(most, size_t(std::max(1, p.groups)) * size_t(p.local_x * p.local_y));
    }
    m.fibers.resize(most);
}

// One schedule of a pixel after the other, each with fragments of its own: prints the colour that comes out.
void picture() {
    unsigned count;
    if (std::scanf("%u", &count) != 1) std::exit(2);
    m.options.robust = true;
    std::printf("{\"colours\": [");
    for (unsigned i = 0; i < count; ++i) {
        m.fragments.clear();
        read_fragments();
        if (m.fibers.size() < m.fragments.size()) m.fibers.resize(m.fragments.size());
        m.options.mode = Random::mixed(i) % 2 ? PRIORITY : RANDOM;
        begin_schedule(i, std::max<uint64_t>(10, m.steps));
        if (i) std::printf(", ");
        if (draw_frame()) print_floats(image());
        else std::printf("[\"%s\"]", m.failure);
    }
    std::printf("]}\n");
}

void set_uniforms(uint32_t seed) {
    const uint32_t* r = frame.region;
    uint32_t first = r[1] * r[2] + r[0];
    const uint32_t values[] = {frame.width, frame.height, frame.width * frame.height, frame.capacity, seed, 0xFFFFFFFFu,
                               frame.chosen_k, first, r[2], r[2] * r[3], r[0], r[1], r[0] + r[2], r[1] + r[3],
                               0, 0x3F800000u, 0};  // a box of all depths, 0 to 1
    std::copy(std::begin(values), std::end(values), m.uniforms);
}

bool flag(int count, char** arguments, const std::string& name) {
    for (int i = 2; i < count; ++i)
        if (name == arguments[i]) return true;
    return false;
}

uint64_t number(int count, char** arguments, const std::string& name, uint64_t otherwise) {
    for (int i = 2; i < count; ++i)
        if (std::string(arguments[i]).rfind(name + "=", 0) == 0) return std::strtoull(arguments[i] + name.size() + 1, nullptr, 10);
    return otherwise;
}
}  // namespace

int run(int count, char** arguments) {
    std::string what = count > 1 ? arguments[1] : "";
    m.options.weak = flag(count, arguments, "weak");
    m.options.dependencies = !flag(count, arguments, "no-dependencies");
    m.options.ordered = flag(count, arguments, "ordered");
    m.options.late = flag(count, arguments, "late");
    m.options.one_failure = !flag(count, arguments, "all");
    m.options.may_lose = flag(count, arguments, "may-lose");
    m.options.warp = int(number(count, arguments, "warp", 0));
    m.options.bound = int(number(count, arguments, "bound", 2));
    m.options.in_flight = int(number(count, arguments, "in-flight", 0));
    m.options.seed = number(count, arguments, "seed", 1);
    m.options.schedules = number(count, arguments, "schedules", 1000);
    read_scene();
    read_images(m.allowed);
    std::vector<std::vector<float>> bounds;
    read_images(bounds);
    if (bounds.size() == 2) low_bound = bounds[0], high_bound = bounds[1];
    if (what != "picture") read_deviations();
    allocate();
    set_uniforms(uint32_t(number(count, arguments, "scene", 1)));
    if (what == "reference") {
        m.allowed.clear();
        reference();
    } else if (what == "replay") {
        replay();
    } else if (what == "picture") {
        picture();
    } else {
        m.options.mode = what == "exhaustive" ? EXHAUSTIVE : RANDOM;
        check(!flag(count, arguments, "unshrunk"));
    }
    return 0;
}
}  // namespace race

int main(int count, char** arguments) { return race::run(count, arguments); }
