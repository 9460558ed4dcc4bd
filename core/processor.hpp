// Which variants the CPU and the operating system can run.
#pragma once

#include <string>
#include <vector>

#if defined(__x86_64__)
#include <cpuid.h>
#endif

namespace core {

#if defined(__x86_64__)
// __builtin_cpu_supports would do, but Zig's runtime library leaves its answers at "no".
struct Features {
    bool avx2 = false;
    bool avx512 = false;
};

inline bool all(unsigned bits, unsigned wanted) { return (bits & wanted) == wanted; }

inline Features features() {
    unsigned a = 0, b = 0, c = 0, d = 0;
    if (__get_cpuid(1, &a, &b, &c, &d) == 0 || !all(c, bit_OSXSAVE | bit_AVX | bit_FMA)) {
        return {};
    }
    // The CPU having the registers is not enough: the operating system must save them, too.
    unsigned saved = 0, high = 0;
    __asm__("xgetbv" : "=a"(saved), "=d"(high) : "c"(0));
    constexpr unsigned ymm = 0x6, zmm = 0xe6;
    if (__get_cpuid_count(7, 0, &a, &b, &c, &d) == 0) {
        return {};
    }
    const bool avx2 = all(saved, ymm) && all(b, bit_AVX2);
    const bool avx512 = avx2 && all(saved, zmm) && all(b, bit_AVX512F | bit_AVX512DQ | bit_AVX512VL);
    return {avx2, avx512};
}
#endif

// From the slowest to the fastest; the names are those of CMakeLists.txt, which says if there is one alone.
inline std::vector<std::string> supported_variants() {
    std::vector<std::string> variants{"baseline"};
#if defined(__x86_64__) && !defined(CORE_ALONE)
    const Features found = features();
    if (found.avx2) {
        variants.emplace_back("avx2");
    }
    if (found.avx512) {
        variants.emplace_back("avx512");
    }
#endif
    return variants;
}

} // namespace core
