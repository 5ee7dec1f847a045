// Draws a frame: the passes in order, and around the shaders what a rasterizer does with their outputs.
#include "machine.hpp"
#include <algorithm>
#include <cstdlib>

namespace race {
namespace {
enum Format { F_R8, F_RG8, F_RGBA8, F_R16, F_RGBA16F, F_R32F, F_RG32F, F_RGBA32F, F_R32UI, F_RG32UI, F_D16, F_D32F, F_D24S8 };
enum Factor { ZERO, ONE, ONE_MINUS_SRC_ALPHA, DST_ALPHA, ONE_MINUS_DST_ALPHA, SRC_ALPHA };
constexpr uint32_t TILE_PIXELS = 16;  // side of a listed tile
constexpr uint32_t COMMAND_WORDS = 5;  // of an indirect draw
int passed;                           // of the pass that is drawn, by the samples that it let through

uint32_t pixels() { return frame.width * frame.height; }
int copy_of(int role, int copies) { return role ? (m.iteration + (role == 2)) % copies : 0; }

uint32_t* texel(int target, int role, int layer, int sample, uint32_t x, uint32_t y) {
    const TargetDesc& t = frame.targets[target];
    size_t at = size_t(((copy_of(role, t.copies) * t.layers + layer) * t.samples + sample)) * pixels() + y * frame.width + x;
    return &m.texels[size_t(target)][4 * at];
}

float stored(float v, int format) {
    switch (format) {
        case F_R8: case F_RG8: case F_RGBA8: return float(glsl::unorm(v, 255.0f)) / 255.0f;
        case F_R16: case F_D16: return float(glsl::unorm(v, 65535.0f)) / 65535.0f;
        case F_RGBA16F: return glsl::half_value(glsl::half_bits(v));
        case F_D24S8: return float(double(uint32_t(double(v) * 16777215.0 + 0.5)) / 16777215.0);
        default: return v;
    }
}

int channels(int format) {
    switch (format) {
        case F_RG8: case F_RG32F: case F_RG32UI: return 2;
        case F_RGBA8: case F_RGBA16F: case F_RGBA32F: return 4;
        default: return 1;
    }
}

// What is read of a texel: absent channels are 0, an absent alpha 1.
void write_texel(int target, uint32_t* to, const uint32_t* value) {
    const TargetDesc& t = frame.targets[target];
    int held = channels(t.format);
    for (int c = 0; c < 4; ++c) {
        bool there = c < held;
        if (t.integer) to[c] = there ? value[c] : c == 3;
        else to[c] = glsl::bits(there ? stored(glsl::from_bits(value[c]), t.format) : c == 3 ? 1.0f : 0.0f);
    }
}

bool is_stencilled(const TargetDesc& t) { return t.format == F_D24S8; }
uint8_t* stencil_of(int sample, uint32_t x, uint32_t y) { return &m.stencil[size_t(sample) * pixels() + y * frame.width + x]; }

void clear_outputs(const PassDesc& p) {
    const uint32_t* r = frame.region;
    for (int i = 0; i < p.output_count; ++i) {
        const OutputDesc& o = p.outputs[i];
        const TargetDesc& t = frame.targets[o.target];
        if (!o.clears) continue;
        uint32_t value[4];
        for (int c = 0; c < 4; ++c) value[c] = t.integer ? uint32_t(int64_t(o.clear[c])) : glsl::bits(o.clear[c]);
        if (t.integer && o.clear[0] > 4e9f) value[0] = 0xFFFFFFFFu;
        for (uint32_t y = 0; y < frame.height; ++y)
            for (uint32_t x = 0; x < frame.width; ++x) {
                bool within = x >= r[0] && x < r[0] + r[2] && y >= r[1] && y < r[1] + r[3];
                if (p.region && within == (p.kind == CLEAR)) continue;
                for (int layer = 0; layer < t.layers; ++layer)
                    for (int sample = 0; sample < t.samples; ++sample) {
                        write_texel(o.target, texel(o.target, o.role, layer, sample, x, y), value);
                        if (is_stencilled(t)) *stencil_of(sample, x, y) = uint8_t(o.clear[1]);
                    }
            }
    }
}

const OutputDesc* depth_output(const PassDesc& p) {
    for (int i = 0; i < p.output_count; ++i)
        if (frame.targets[p.outputs[i].target].depth) return &p.outputs[i];
    return nullptr;
}

bool depth_passes(const PassDesc& p, const OutputDesc& o, uint32_t x, uint32_t y, int sample, float z) {
    float held = glsl::from_bits(*texel(o.target, o.role, 0, sample, x, y));
    float mine = stored(z, frame.targets[o.target].format);
    return p.depth_test == 1 ? mine < held : p.depth_test == 2 ? mine <= held : p.depth_test == 3 ? mine == held : true;
}

float factor(int which, const float* source, const float* destination) {
    switch (which) {
        case ZERO: return 0.0f;
        case ONE_MINUS_SRC_ALPHA: return 1.0f - source[3];
        case DST_ALPHA: return destination[3];
        case ONE_MINUS_DST_ALPHA: return 1.0f - destination[3];
        case SRC_ALPHA: return source[3];
        default: return 1.0f;
    }
}

void blend(const BlendDesc& b, const uint32_t* source_bits, uint32_t* into, int target) {
    float source[4], destination[4];
    uint32_t result[4];
    for (int c = 0; c < 4; ++c) source[c] = glsl::from_bits(source_bits[c]), destination[c] = glsl::from_bits(into[c]);
    for (int c = 0; c < 4; ++c) {
        bool alpha = c == 3;
        float s = source[c] * factor(alpha ? b.source_alpha : b.source, source, destination);
        float d = destination[c] * factor(alpha ? b.destination_alpha : b.destination, source, destination);
        result[c] = glsl::bits(b.equation == 2 ? std::max(source[c], destination[c]) : s + d);
    }
    write_texel(target, into, result);
}

void write_sample(const PassDesc& p, const Fiber& f, int sample) {
    for (int i = 0; i < p.output_count; ++i) {
        const OutputDesc& o = p.outputs[i];
        const TargetDesc& t = frame.targets[o.target];
        if (t.depth || o.keeps) continue;
        for (int layer = 0; layer < o.layers; ++layer) {
            int location = o.location + layer;
            uint32_t* to = texel(o.target, o.role, layer, sample < t.samples ? sample : 0, f.in.x, f.in.y);
            const BlendDesc& b = p.blends[p.blend_count > 1 ? std::min(i, p.blend_count - 1) : 0];
            if (p.blend_count && b.equation) blend(b, f.out.colour[location], to, o.target);
            else write_texel(o.target, to, f.out.colour[location]);
        }
    }
}

// The tests behind the shader, and what is written where they pass.
void raster(const PassDesc& p, const Fiber& f) {
    if (f.out.discarded || f.in.helper) return;
    const OutputDesc* depth = depth_output(p);
    int samples = depth ? frame.targets[depth->target].samples : 1;
    float z = f.out.has_depth ? f.out.depth : f.in.z;
    bool any = false;
    for (int sample = 0; sample < samples; ++sample) {
        if (p.uses_mask && !(f.out.mask >> sample & 1u)) continue;
        bool pass = true;
        if (p.stencil_test) {
            uint8_t& s = *stencil_of(sample, f.in.x, f.in.y);
            pass = p.stencil_test == 1 || s == p.stencil_reference;
            if (p.stencil_update == 1 && s < 255) ++s;
            if (p.stencil_update == 2 && s > 0) --s;
        }
        if (pass && depth && p.depth_test && !p.early) pass = depth_passes(p, *depth, f.in.x, f.in.y, sample, z);
        if (!pass) continue;
        any = true;
        if (depth && p.depth_test && p.depth_write) {
            uint32_t value[4] = {glsl::bits(z), 0, 0, 0};
            write_texel(depth->target, texel(depth->target, depth->role, 0, sample, f.in.x, f.in.y), value);
        }
        write_sample(p, f, sample);
    }
    passed += any;
}

Fiber& next_fiber() {
    if (size_t(m.used) == m.fibers.size()) m.failure = "too_many_invocations";
    Fiber& f = m.fibers[size_t(m.used)];
    f.id = m.used++;
    f.in = Inputs();
    f.group = 0;
    return f;
}

bool early_out(const PassDesc& p, uint32_t x, uint32_t y, float z) {
    const OutputDesc* depth = p.early && p.depth_test ? depth_output(p) : nullptr;
    return depth && !depth_passes(p, *depth, x, y, 0, z);
}

void place_fragment(const PassDesc& p, const Fragment& fragment, uint32_t quad) {
    float z = glsl::from_bits(fragment.depth);
    if (p.corner && (fragment.x != frame.region[0] || fragment.y != frame.region[1])) return;
    if (early_out(p, fragment.x, fragment.y, z)) return;
    Fiber& f = next_fiber();
    f.in.x = fragment.x, f.in.y = fragment.y, f.in.z = z, f.in.quad = quad;
    f.in.payload = fragment.rgba, f.in.helper = fragment.helper;
    start_fiber(f);
}

// The fragments of each primitive for which a command draws an instance, in the order of the commands.
void place_fragments_by_commands(const PassDesc& p) {
    const uint32_t* words = &m.memory[m.first[size_t(p.command)]];
    for (uint32_t at = 0; at + COMMAND_WORDS <= frame.buffers[p.command].words; at += COMMAND_WORDS)
        for (const Fragment& fragment : m.fragments)
            if (words[at] == 4 && words[at + 1] == 1 && fragment.quad == words[at + 3]) place_fragment(p, fragment, 0);
}

void place_fragments(const PassDesc& p) {
    if (p.command >= 0) return place_fragments_by_commands(p);
    for (const Fragment& fragment : m.fragments) place_fragment(p, fragment, fragment.quad);
}

bool drawn_by_command(const PassDesc& p) {
    if (p.command < 0) return true;
    const uint32_t* words = &m.memory[m.first[size_t(p.command)] + COMMAND_WORDS * uint32_t(p.command_class)];
    return words[0] >= 3 && words[1] >= 1;
}

bool listed(uint32_t x, uint32_t y) {
    uint32_t columns = (frame.width + TILE_PIXELS - 1) / TILE_PIXELS, tile = y / TILE_PIXELS * columns + x / TILE_PIXELS;
    const uint32_t* list = &m.memory[m.first[size_t(frame.tile_list)]];
    uint32_t count = m.memory[m.first[size_t(frame.tile_command)]];
    for (uint32_t i = 0; i < count; ++i)
        if (list[i] == tile) return true;
    return false;
}

void place_pixels(const PassDesc& p, int instance) {
    if (!drawn_by_command(p)) return;
    const uint32_t whole[4] = {0, 0, frame.width, frame.height}, *r = p.region ? frame.region : whole;
    float z = p.command_class >= 0 ? float(p.command_class) / 16.0f : 0.5f;
    for (uint32_t y = r[1]; y < r[1] + r[3]; ++y)
        for (uint32_t x = r[0]; x < r[0] + r[2]; ++x) {
            if ((p.by_tile && !listed(x, y)) || early_out(p, x, y, z)) continue;
            Fiber& f = next_fiber();
            f.in.x = x, f.in.y = y, f.in.z = z, f.in.instance = uint32_t(instance);
            start_fiber(f);
        }
}

void place_groups(const PassDesc& p) {
    uint32_t groups = p.by_tile ? m.memory[m.first[size_t(frame.tile_command)] + 4] : uint32_t(p.groups);
    for (uint32_t group = 0; group < groups; ++group)
        for (int y = 0; y < p.local_y; ++y)
            for (int x = 0; x < p.local_x; ++x) {
                Fiber& f = next_fiber();
                f.group = int(group);
                f.in.group = group, f.in.groups = groups;
                f.in.local_x = uint32_t(x), f.in.local_y = uint32_t(y), f.in.local_index = uint32_t(y * p.local_x + x);
                start_fiber(f);
            }
    m.at_barrier.assign(groups, 0);
    m.shared.assign(size_t(groups) * p.shared_words, 0xA5A5A5A5u);
    for (int i = 0; i < 8; ++i) m.bound[SHARED_SLOT + i] = {0, p.shared_words, true};
}

void bind(const PassDesc& p) {
    for (int slot = 0; slot <= p.binding_count; ++slot) {  // the diagnostics stand behind the others
        const BindingDesc& b = p.bindings[slot];
        const BufferDesc& buffer = frame.buffers[b.buffer];
        uint32_t first = m.first[size_t(b.buffer)] + uint32_t(copy_of(b.role, buffer.copies)) * buffer.words;
        m.bound[slot] = {first, buffer.words, b.coherent};
    }
}

void zero(const PassDesc& p) {
    for (int i = 0; i < p.written_count; ++i) {
        const Bound& b = m.bound[p.written[i]];
        std::fill_n(&m.memory[b.first], b.words, 0u);
    }
}

void set_order() {
    bool keep = m.options.mode != SEQUENTIAL || m.pass->kind != GEOMETRY || m.pass->ordered || m.pass->fetches;
    m.order.resize(size_t(m.used));
    for (int i = 0; i < m.used; ++i) m.order[size_t(i)] = i;
    if (!keep)
        for (size_t i = m.order.size(); i > 1; --i) std::swap(m.order[i - 1], m.order[m.random.below(uint32_t(i))]);
}

void shade(const PassDesc& p) {
    m.solo = !p.concurrent || m.options.mode == SEQUENTIAL;
    lockstep_on = m.options.warp > 0 && !m.solo && p.kind != COMPUTE && !p.interlocked && !p.fetches;
    if (m.options.mode == PRIORITY)
        for (int i = 0; i < m.used; ++i) m.fibers[size_t(i)].priority = 1 + int(m.random.below(1u << 20));
    set_order();
    run_fibers();
    m.current = nullptr;
    if (!m.failure) publish_all();
    lockstep_on = false;
    if (p.kind == COMPUTE || p.fetches) return;  // of the latter each was written when it ended
    for (int i = 0; i < m.used && !m.failure; ++i) raster(p, m.fibers[size_t(i)]);
}

void draw(const PassDesc& p) {
    for (int instance = 0; instance < (p.kind == FULLSCREEN ? p.instances : 1) && !m.failure; ++instance) {
        m.used = m.live = m.on_the_way = 0;
        m.waiting = 0;
        m.ready.clear();
        if (p.kind == GEOMETRY) place_fragments(p);
        else if (p.kind == FULLSCREEN) place_pixels(p, instance);
        else place_groups(p);
        if (!m.failure) shade(p);
    }
}

void run_pass(const StepDesc& step) {
    const PassDesc& p = frame.passes[step.pass];
    m.pass = &p;
    m.pass_index = step.pass;
    m.iteration = step.iteration;
    m.uniforms[ITERATION] = uint32_t(step.iteration);
    m.current = nullptr;
    passed = 0;
    bind(p);
    clear_outputs(p);
    if (p.kind == CLEAR) zero(p);
    else draw(p);
    if (p.sets_capacity) m.uniforms[CAPACITY] = uint32_t(passed);
}

void start() {
    m.memory = m.poison;
    m.steps = m.last_change = 0;
    m.lockstep_choices = 0;
    m.failure = nullptr;
    m.failed_site = m.failed_fiber = -1;
    m.deviations.clear();
    m.events.clear();
    m.uniforms[CAPACITY] = frame.capacity;
}
}  // namespace

void raster_now(const Fiber& f) { raster(*m.pass, f); }

static const uint32_t* own_texel(int location) {
    for (int i = 0; i < m.pass->output_count; ++i) {
        const OutputDesc& o = m.pass->outputs[i];
        if (o.layers && o.location == location && !frame.targets[o.target].depth)
            return texel(o.target, o.role, 0, 0, inputs().x, inputs().y);
    }
    std::abort();  // the translator gives each output that is fetched a location
}

glsl::V4<float> fetched_float(int location) {
    const uint32_t* at = own_texel(location);
    return {glsl::from_bits(at[0]), glsl::from_bits(at[1]), glsl::from_bits(at[2]), glsl::from_bits(at[3])};
}

glsl::V4<Uint> fetched_uint(int location) {
    const uint32_t* at = own_texel(location);
    return {Uint(at[0]), Uint(at[1]), Uint(at[2]), Uint(at[3])};
}

bool draw_frame() {
    start();
    for (int at = 0; at < frame.step_count;) {
        m.step = at;
        run_pass(frame.steps[at]);
        if (m.failure) {  // a pass that failed half way leaves versions behind
            for (uint32_t address : m.touched) m.history[address].clear();
            m.touched.clear();
            m.clock = 0;
            lockstep_on = false;
            return false;
        }
        bool leave = frame.passes[frame.steps[at].pass].counts && !passed && frame.steps[at].leave >= 0;
        at = leave ? frame.steps[at].leave : at + 1;
    }
    return true;
}

glsl::V4<float> fetch_float(int unit, int x, int y, int layer, int sample) {
    const TextureDesc& t = m.pass->textures[unit];
    if (x < 0 || y < 0 || uint32_t(x) >= frame.width || uint32_t(y) >= frame.height) return {};
    const uint32_t* at = texel(t.target, t.role, layer, sample, uint32_t(x), uint32_t(y));
    return {glsl::from_bits(at[0]), glsl::from_bits(at[1]), glsl::from_bits(at[2]), glsl::from_bits(at[3])};
}

glsl::V4<Uint> fetch_uint(int unit, int x, int y, int layer, int sample) {
    const TextureDesc& t = m.pass->textures[unit];
    if (x < 0 || y < 0 || uint32_t(x) >= frame.width || uint32_t(y) >= frame.height) return {};
    const uint32_t* at = texel(t.target, t.role, layer, sample, uint32_t(x), uint32_t(y));
    return {Uint(at[0]), Uint(at[1]), Uint(at[2]), Uint(at[3])};
}

void store_image(int location, int x, int y, glsl::V4<float> colour) {
    if (x < 0 || y < 0 || uint32_t(x) >= frame.width || uint32_t(y) >= frame.height) return;
    for (int i = 0; i < m.pass->output_count; ++i) {
        const OutputDesc& o = m.pass->outputs[i];
        if (o.location != location) continue;
        const float parts[4] = {colour.x, colour.y, colour.z, colour.w};
        uint32_t value[4];
        for (int c = 0; c < 4; ++c) value[c] = glsl::bits(parts[c]);
        write_texel(o.target, texel(o.target, o.role, 0, 0, uint32_t(x), uint32_t(y)), value);
    }
}
}  // namespace race
