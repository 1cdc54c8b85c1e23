// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "server/busy.hpp"
#include "server/options.hpp"
#include "server/sources/frame_source.hpp"
#include "server/web/api.hpp"
#include "server/web/feed.hpp"
#include "server/web/recent_log.hpp"

namespace bpa::server::web {

/// The page that the server offers to browsers, from open() until it is destroyed.
class Page {
 public:
  virtual ~Page() = default;

  /// Where browsers find it, with the token if one was made.
  virtual std::string address() const = 0;
  /// What was refused, dropped and cut off. Call it now and then: it also forgets viewers that are
  /// gone.
  virtual SourceReport report() = 0;
  /// What the thread that answers requests does now.
  virtual const Busy& busy() const = 0;
};

/// Serves what `feed` and `log` hold, which outlive the page. Throws a Failure.
std::unique_ptr<Page> open_page(const WebOptions& options, PageLinks links, Feed& feed,
                                const RecentLog& log);

}  // namespace bpa::server::web
