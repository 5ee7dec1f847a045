// GLSL's types and functions for C++. A whole number from memory knows when it was loaded (`since`), and so does what
// is computed from it: a load whose address depends on an earlier one cannot have happened before that.
#pragma once
#include <cmath>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace glsl {

struct Uint {
    uint32_t v = 0, since = 0;
    Uint() = default;
    Uint(uint32_t value, uint32_t loaded) : v(value), since(loaded) {}
    Uint(uint32_t value) : v(value) {}
    Uint(int value) : v(uint32_t(value)) {}
    Uint(bool) = delete;
};
struct U64 {
    uint64_t v = 0;
    uint32_t since = 0;
    U64() = default;
    U64(uint64_t value, uint32_t loaded) : v(value), since(loaded) {}
    U64(int value) : v(uint64_t(int64_t(value))) {}
};

inline uint32_t later(uint32_t a, uint32_t b) { return a > b ? a : b; }
inline uint32_t div_or_ones(uint32_t a, uint32_t b) { return b ? a / b : 0xFFFFFFFFu; }  // undefined in GLSL
inline uint32_t mod_or_self(uint32_t a, uint32_t b) { return b ? a % b : a; }

#define UINT_OPERATOR(op, result) \
    inline Uint operator op(Uint a, Uint b) { return {result, later(a.since, b.since)}; } \
    inline Uint& operator op##=(Uint& a, Uint b) { return a = a op b; }
UINT_OPERATOR(+, a.v + b.v)
UINT_OPERATOR(-, a.v - b.v)
UINT_OPERATOR(*, a.v* b.v)
UINT_OPERATOR(/, div_or_ones(a.v, b.v))
UINT_OPERATOR(%, mod_or_self(a.v, b.v))
UINT_OPERATOR(&, a.v& b.v)
UINT_OPERATOR(|, a.v | b.v)
UINT_OPERATOR(^, a.v ^ b.v)
UINT_OPERATOR(<<, a.v << (b.v & 31u))
UINT_OPERATOR(>>, a.v >> (b.v & 31u))
#undef UINT_OPERATOR
inline int operator<<(int a, Uint b) { return int(uint32_t(a) << (b.v & 31u)); }
inline int operator>>(int a, Uint b) { return a >> (b.v & 31u); }
inline Uint operator~(Uint a) { return {~a.v, a.since}; }
inline Uint operator-(Uint a) { return {0u - a.v, a.since}; }
inline Uint operator+(Uint a) { return a; }
inline Uint& operator++(Uint& a) { ++a.v; return a; }
inline Uint& operator--(Uint& a) { --a.v; return a; }
inline Uint operator++(Uint& a, int) { Uint old = a; ++a.v; return old; }
inline Uint operator--(Uint& a, int) { Uint old = a; --a.v; return old; }
#define COMPARE(op) \
    inline bool operator op(Uint a, Uint b) { return a.v op b.v; } \
    inline bool operator op(U64 a, U64 b) { return a.v op b.v; }
COMPARE(==) COMPARE(!=) COMPARE(<) COMPARE(>) COMPARE(<=) COMPARE(>=)
#undef COMPARE

// Conversion of one component.
template <class To, class From> struct Cast { static To of(From a) { return To(a); } };
template <class From> struct Cast<Uint, From> { static Uint of(From a) { return Uint(uint32_t(a)); } };
template <> struct Cast<Uint, Uint> { static Uint of(Uint a) { return a; } };
template <> struct Cast<Uint, float> { static Uint of(float a) {
    return Uint(a <= 0.0f || a != a ? (a <= -1.0f ? uint32_t(int64_t(a)) : 0u) : a >= 4294967296.0f ? 0xFFFFFFFFu : uint32_t(a)); } };
template <class To> struct Cast<To, Uint> { static To of(Uint a) { return To(a.v); } };
template <> struct Cast<int, Uint> { static int of(Uint a) { return int(a.v); } };
template <> struct Cast<bool, Uint> { static bool of(Uint a) { return a.v != 0; } };
template <> struct Cast<int, float> { static int of(float a) {
    return a >= 2147483648.0f ? INT32_MAX : a <= -2147483648.0f || a != a ? INT32_MIN : int(a); } };
template <> struct Cast<U64, Uint> { static U64 of(Uint a) { return {a.v, a.since}; } };
template <> struct Cast<Uint, U64> { static Uint of(U64 a) { return {uint32_t(a.v), a.since}; } };
template <> struct Cast<U64, U64> { static U64 of(U64 a) { return a; } };

// Keeps a template argument from being deduced, so that a scalar converts.
template <class T> struct Same { using type = T; };
template <class T> using Plain = typename Same<T>::type;

template <class T> struct V2 { T x{}, y{}; };
template <class T> struct V3 { T x{}, y{}, z{}; };
template <class T> struct V4 { T x{}, y{}, z{}, w{}; };
template <class T, int N> struct VecOf;
template <class T> struct VecOf<T, 2> { using type = V2<T>; };
template <class T> struct VecOf<T, 3> { using type = V3<T>; };
template <class T> struct VecOf<T, 4> { using type = V4<T>; };
template <class T, int N> using Vec = typename VecOf<T, N>::type;

template <class X> struct Shape { static constexpr int size = 1; using Part = X; static constexpr bool vector = false; };
#define SHAPE(V, N) template <class T> struct Shape<V<T>> { \
    static constexpr int size = N; using Part = T; static constexpr bool vector = true; };
SHAPE(V2, 2) SHAPE(V3, 3) SHAPE(V4, 4)
#undef SHAPE
template <class X> constexpr bool is_vector = Shape<X>::vector;
template <class X> using Part = typename Shape<X>::Part;

template <class X> Part<X>& part(X& a, int i) {
    if constexpr (is_vector<X>) return (&a.x)[i]; else return a;
}
template <class X> const Part<X>& part(const X& a, int i) {
    if constexpr (is_vector<X>) return (&a.x)[i]; else return a;
}

template <class R, class F, class... X> R each(F f, const X&... a) {
    R result{};
    for (int i = 0; i < Shape<R>::size; ++i) part(result, i) = f(part(a, i)...);
    return result;
}

#define VECTOR_OPERATOR(op) \
    template <class T> V2<T> operator op(V2<T> a, V2<T> b) { return {T(a.x op b.x), T(a.y op b.y)}; } \
    template <class T> V2<T> operator op(V2<T> a, Plain<T> b) { return {T(a.x op b), T(a.y op b)}; } \
    template <class T> V2<T> operator op(Plain<T> a, V2<T> b) { return {T(a op b.x), T(a op b.y)}; } \
    template <class T> V3<T> operator op(V3<T> a, V3<T> b) { return {T(a.x op b.x), T(a.y op b.y), T(a.z op b.z)}; } \
    template <class T> V3<T> operator op(V3<T> a, Plain<T> b) { return {T(a.x op b), T(a.y op b), T(a.z op b)}; } \
    template <class T> V3<T> operator op(Plain<T> a, V3<T> b) { return {T(a op b.x), T(a op b.y), T(a op b.z)}; } \
    template <class T> V4<T> operator op(V4<T> a, V4<T> b) { \
        return {T(a.x op b.x), T(a.y op b.y), T(a.z op b.z), T(a.w op b.w)}; } \
    template <class T> V4<T> operator op(V4<T> a, Plain<T> b) { \
        return {T(a.x op b), T(a.y op b), T(a.z op b), T(a.w op b)}; } \
    template <class T> V4<T> operator op(Plain<T> a, V4<T> b) { \
        return {T(a op b.x), T(a op b.y), T(a op b.z), T(a op b.w)}; } \
    template <class T, class B> V2<T>& operator op##=(V2<T>& a, B b) { return a = a op b; } \
    template <class T, class B> V3<T>& operator op##=(V3<T>& a, B b) { return a = a op b; } \
    template <class T, class B> V4<T>& operator op##=(V4<T>& a, B b) { return a = a op b; }
VECTOR_OPERATOR(+) VECTOR_OPERATOR(-) VECTOR_OPERATOR(*) VECTOR_OPERATOR(/) VECTOR_OPERATOR(%)
VECTOR_OPERATOR(&) VECTOR_OPERATOR(|) VECTOR_OPERATOR(^) VECTOR_OPERATOR(<<) VECTOR_OPERATOR(>>)
#undef VECTOR_OPERATOR
template <class X, class = std::enable_if_t<is_vector<X>>> X operator-(X a) { return each<X>([](auto v) { return -v; }, a); }
template <class X, class = std::enable_if_t<is_vector<X>>> bool operator==(const X& a, const X& b) {
    for (int i = 0; i < Shape<X>::size; ++i)
        if (!(part(a, i) == part(b, i))) return false;
    return true;
}
template <class X, class = std::enable_if_t<is_vector<X>>> bool operator!=(const X& a, const X& b) { return !(a == b); }

// Constructors: the components of all arguments in order, or one scalar for all.
template <class R, class A> void put(R& result, int& at, const A& a) {
    for (int i = 0; i < Shape<A>::size && at < Shape<R>::size; ++i, ++at)
        part(result, at) = Cast<Part<R>, Part<A>>::of(part(a, i));
}
template <class R, class... A> R make(const A&... a) {
    if constexpr (std::is_class_v<R> && !is_vector<R> && !std::is_same_v<R, Uint> && !std::is_same_v<R, U64>) {
        return R(a...);
    } else {
        R result{};
        int at = 0;
        (put(result, at, a), ...);
        if constexpr (sizeof...(A) == 1)
            if (at == 1)
                for (int i = 1; i < Shape<R>::size; ++i) part(result, i) = part(result, 0);
        return result;
    }
}

// Swizzles of several components, as values and as places to write to.
template <int... I, class X> auto swizzle(const X& a) { return Vec<Part<X>, sizeof...(I)>{part(a, I)...}; }
template <class X, int... I> struct Places {
    X& a;
    template <class B> void operator=(const B& b) {
        int at = 0;
        ((part(a, I) = part(b, at++)), ...);
    }
};
template <int... I, class X> Places<X, I...> places(X& a) { return {a}; }

[[noreturn]] void local_array_overrun(int64_t index, int length, int line);
inline int64_t position(Uint i) { return i.v; }
inline int64_t position(int i) { return i; }
template <class T, int N> struct Array {
    T items[N]{};
    template <class I> T& at(I index, int line) {
        int64_t i = position(index);
        if (i < 0 || i >= N) local_array_overrun(i, N, line);
        return items[i];
    }
};
template <class T, int N, class I> T& element(Array<T, N>& a, I i, int line) { return a.at(i, line); }
template <class T, int N, class I> const T& element(const Array<T, N>& a, I i, int line) {
    return const_cast<Array<T, N>&>(a).at(i, line);
}
template <class X, class I> Part<X>& element(X& a, I i, int) { return part(a, int(position(i))); }
template <class T, class... A> Array<T, sizeof...(A)> array_of(const A&... a) { return {{make<T>(a)...}}; }
template <class T, int N> int array_length(const Array<T, N>&) { return N; }

#define ONE(name, expression) \
    inline float name(float a) { return expression; } \
    template <class X, class = std::enable_if_t<is_vector<X>>> X name(const X& v) { \
        return each<X>([](float a) { return float(expression); }, v); }
ONE(exp, std::exp(a)) ONE(exp2, std::exp2(a)) ONE(log, std::log(a)) ONE(log2, std::log2(a)) ONE(sqrt, std::sqrt(a))
ONE(floor, std::floor(a)) ONE(ceil, std::ceil(a)) ONE(fract, a - std::floor(a)) ONE(inversesqrt, 1.0f / std::sqrt(a))
ONE(round, std::nearbyint(a)) ONE(trunc, std::trunc(a)) ONE(sin, std::sin(a)) ONE(cos, std::cos(a))
#undef ONE
inline float abs(float a) { return std::fabs(a); }
inline int abs(int a) { return a < 0 ? -a : a; }
inline float sign(float a) { return a > 0.0f ? 1.0f : a < 0.0f ? -1.0f : 0.0f; }
inline float pow(float a, float b) { return std::pow(a, b); }
inline Uint min(Uint a, Uint b) { return {a.v < b.v ? a.v : b.v, later(a.since, b.since)}; }
inline Uint max(Uint a, Uint b) { return {a.v > b.v ? a.v : b.v, later(a.since, b.since)}; }
inline int min(int a, int b) { return a < b ? a : b; }
inline int max(int a, int b) { return a > b ? a : b; }
inline float min(float a, float b) { return b < a ? b : a; }
inline float max(float a, float b) { return a < b ? b : a; }
template <class X, class B, class = std::enable_if_t<is_vector<X>>> X min(const X& a, const B& b) {
    X r{};
    for (int i = 0; i < Shape<X>::size; ++i) part(r, i) = min(part(a, i), Part<X>(part(b, i)));
    return r;
}
template <class X, class B, class = std::enable_if_t<is_vector<X>>> X max(const X& a, const B& b) {
    X r{};
    for (int i = 0; i < Shape<X>::size; ++i) part(r, i) = max(part(a, i), Part<X>(part(b, i)));
    return r;
}
template <class X, class B, class C> X clamp(const X& a, const B& low, const C& high) {
    return min(max(a, Part<X>(low)), Part<X>(high));
}
template <class X> X mix(const X& a, const X& b, float t) { return each<X>([t](float p, float q) { return p * (1.0f - t) + q * t; }, a, b); }
template <class X> X mix(const X& a, const X& b, bool t) { return t ? b : a; }
template <class X> float dot(const X& a, const X& b) {
    float sum = 0.0f;
    for (int i = 0; i < Shape<X>::size; ++i) sum += part(a, i) * part(b, i);
    return sum;
}
template <class X> float length(const X& a) { return std::sqrt(dot(a, a)); }
#define COMPARE(name, op) template <class X> auto name(const X& a, const X& b) { \
    return each<Vec<bool, Shape<X>::size>>([](auto p, auto q) { return p op q; }, a, b); }
COMPARE(lessThan, <) COMPARE(lessThanEqual, <=) COMPARE(greaterThan, >) COMPARE(greaterThanEqual, >=)
COMPARE(equal, ==) COMPARE(notEqual, !=)
#undef COMPARE
template <class X> bool all(const X& a) { bool r = true; for (int i = 0; i < Shape<X>::size; ++i) r = r && part(a, i); return r; }
template <class X> bool any(const X& a) { bool r = false; for (int i = 0; i < Shape<X>::size; ++i) r = r || part(a, i); return r; }

inline uint32_t bits(float a) { uint32_t v; std::memcpy(&v, &a, 4); return v; }
inline float from_bits(uint32_t v) { float a; std::memcpy(&a, &v, 4); return a; }
inline Uint floatBitsToUint(float a) { return Uint(bits(a)); }
inline float uintBitsToFloat(Uint a) { return from_bits(a.v); }
inline int findMSB(Uint a) { return a.v ? 31 - __builtin_clz(a.v) : -1; }
inline int findMSB(int a) { return findMSB(Uint(uint32_t(a < 0 ? ~a : a))); }
inline int findLSB(Uint a) { return a.v ? __builtin_ctz(a.v) : -1; }
inline int bitCount(Uint a) { return __builtin_popcount(a.v); }
inline uint32_t unorm(float a, float scale) { return uint32_t(std::nearbyint((a < 0.0f || a != a ? 0.0f : a > 1.0f ? 1.0f : a) * scale)); }
inline Uint packUnorm4x8(V4<float> a) {
    return Uint(unorm(a.x, 255.0f) | unorm(a.y, 255.0f) << 8 | unorm(a.z, 255.0f) << 16 | unorm(a.w, 255.0f) << 24);
}
inline V4<float> unpackUnorm4x8(Uint a) {
    return {float(a.v & 255u) / 255.0f, float(a.v >> 8 & 255u) / 255.0f, float(a.v >> 16 & 255u) / 255.0f, float(a.v >> 24) / 255.0f};
}
uint32_t half_bits(float a);
float half_value(uint32_t h);
inline Uint packHalf2x16(V2<float> a) { return Uint(half_bits(a.x) | half_bits(a.y) << 16); }
inline V2<float> unpackHalf2x16(Uint a) { return {half_value(a.v & 0xFFFFu), half_value(a.v >> 16)}; }
inline U64 packUint2x32(V2<Uint> a) { return {a.x.v | uint64_t(a.y.v) << 32, later(a.x.since, a.y.since)}; }
inline U64 packInt2x32(V2<int> a) { return {uint32_t(a.x) | uint64_t(uint32_t(a.y)) << 32, 0}; }
inline V2<int> unpackInt2x32(U64 a) { return {int(uint32_t(a.v)), int(uint32_t(a.v >> 32))}; }
inline V2<Uint> unpackUint2x32(U64 a) { return {Uint(uint32_t(a.v), a.since), Uint(uint32_t(a.v >> 32), a.since)}; }

}  // namespace glsl
