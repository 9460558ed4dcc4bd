// Tasks over threads.  Each task writes its own results, so their number changes nothing.
#pragma once

#include <atomic>
#include <thread>
#include <vector>

namespace core {

// Whether the caller has asked to stop: set by another thread, looked at between pieces of work.
class Stop {
    std::atomic<bool> flag{false};

public:
    void ask() { flag.store(true, std::memory_order_relaxed); }
    bool asked() const { return flag.load(std::memory_order_relaxed); }
};

inline std::atomic<int>& thread_count() {
    static std::atomic<int> count{int(std::max(1u, std::thread::hardware_concurrency()))};
    return count;
}

template <class Task>
inline void in_parallel(int tasks, Stop& stop, Task task) {
    std::atomic<int> next{0};
    auto work = [&] {
        for (int i = next++; i < tasks && !stop.asked(); i = next++) task(i);
    };
    int helpers = std::min(thread_count().load(), tasks) - 1;
    std::vector<std::thread> threads;
    for (int i = 0; i < helpers; ++i) threads.emplace_back(work);
    work();
    for (auto& thread : threads) thread.join();
}

}  // namespace core
