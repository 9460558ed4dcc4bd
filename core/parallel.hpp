// Tasks over threads.  Each task writes its own results, so their number changes nothing.
#pragma once

#include <algorithm>
#include <atomic>
#include <vector>

#if !defined(__wasm__)
#include <exception>
#include <mutex>
#include <system_error>
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

// The caller is one of the threads.  Where the system grants fewer, these do all; what one of them throws, the caller does.
template <class Work>
inline void in_threads(int count, Work& work) {
    std::mutex mutex;
    std::exception_ptr failed;
    auto guarded = [&] {
        try {
            work();
        } catch (...) {
            std::lock_guard lock(mutex);
            if (!failed) failed = std::current_exception();
        }
    };
    std::vector<std::thread> helpers;
    try {
        for (int i = 1; i < count; ++i) helpers.emplace_back(guarded);
    } catch (const std::system_error&) {
    }
    guarded();
    for (auto& helper : helpers) helper.join();
    if (failed) std::rethrow_exception(failed);
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
