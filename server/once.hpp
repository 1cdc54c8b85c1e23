// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cassert>
#include <concepts>
#include <future>
#include <type_traits>
#include <utility>

namespace bpa::server {

/// Work that is done once at most, since it consumes what it holds. Move-only; only an rvalue can
/// be called, std::move(work)(), and it is empty afterwards.
template <class T>
class Once {
 public:
  Once() = default;
  template <class F>
  requires(!std::same_as<std::remove_cvref_t<F>, Once> && std::is_invocable_r_v<T, F>)
      Once(F work)  // NOLINT: implicit on purpose
      : work_(std::move(work)) {}

  explicit operator bool() const { return work_.valid(); }
  /// Calling an empty one is a caller's bug.
  T operator()() && {
    assert(work_.valid());
    std::packaged_task<T()> work = std::move(work_);
    work();
    return work.get_future().get();
  }

 private:
  std::packaged_task<T()> work_;
};

}  // namespace bpa::server
