// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Replaces operator new by one that counts its calls. Only the program bpa has it; its library and
// the tests do not.
#include "tools/allocations.hpp"

#include <array>
#include <atomic>
#include <cstdlib>
#include <new>

namespace {

// Threads count apart, so that they do not wait for each other.
struct alignas(64) Counter {
  std::atomic<std::uint64_t> calls;
};
constinit std::array<Counter, 64> counters{};
constinit std::atomic<std::size_t> threads{0};

void* allocate(std::size_t size, std::size_t alignment) {
  thread_local const std::size_t own = threads++ % counters.size();
  counters[own].calls.fetch_add(1, std::memory_order_relaxed);
  if (size == 0) size = 1;
  while (true) {
    void* memory = alignment == 0 ? std::malloc(size)
                                  : std::aligned_alloc(
                                        alignment, (size + alignment - 1) / alignment * alignment);
    if (memory) return memory;
    const std::new_handler handler = std::get_new_handler();
    if (!handler) throw std::bad_alloc();
    handler();
  }
}

}  // namespace

std::uint64_t bpa::cli::count_allocations() {
  std::uint64_t sum = 0;
  for (const Counter& counter : counters) sum += counter.calls.load(std::memory_order_relaxed);
  return sum;
}

// Arrays call these. The forms that do not throw would, but for AddressSanitizer's own.
void* operator new(std::size_t size) { return allocate(size, 0); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocate(size, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  try {
    return allocate(size, 0);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}
void* operator new(std::size_t size, std::align_val_t alignment, const std::nothrow_t&) noexcept {
  try {
    return allocate(size, static_cast<std::size_t>(alignment));
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
