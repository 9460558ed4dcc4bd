// Tasks over threads.  Each task writes its own results, so their number changes nothing.
#pragma once

#include <algorithm>
#include <atomic>
#include <vector>

#if !defined(__wasm__)
#include <thread>
#endif

namespace core {

// Whether the caller has asked to stop: set by another thread, looked at between pieces of work.
class Stop {
    std::atomic<bool> flag{false};

public:
    void ask() { flag.store(true, std::memory_order_relaxed); }
    bool asked() const { return flag.load(std::memory_order_relaxed); }
};

#if defined(__wasm__)
// There are no threads: the caller does all work by itself.
inline int processors() { return 1; }

template <class Work>
inline void in_threads(int, Work& work) { work(); }
#else
inline int processors() { return int(std::max(1u, std::thread::hardware_concurrency())); }

// The caller is one of the threads.
template <class Work>
inline void in_threads(int count, Work& work) {
    std::vector<std::thread> helpers;
    for (int i = 1; i < count; ++i) helpers.emplace_back([&] { work(); });
    work();
    for (auto& helper : helpers) helper.join();
}
#endif

inline std::atomic<int>& thread_count() {
    static std::atomic<int> count{processors()};
    return count;
}

template <class Task>
inline void in_parallel(int tasks, Stop& stop, Task task) {
    std::atomic<int> next{0};
    auto work = [&] {
        for (int i = next++; i < tasks && !stop.asked(); i = next++) task(i);
    };
    in_threads(std::min(thread_count().load(), tasks), work);
}

}  // namespace core
