// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/group_servers.hpp"

#include <chrono>
#include <cstdlib>
#include <mutex>
#include <thread>
#include <utility>

#include <unistd.h>

#include "core/base/concat.hpp"
#include "core/base/failure.hpp"
#include "server/group/claims.hpp"
#include "server/group/session.hpp"
#include "server/group/worker.hpp"
#include "server/participant_options.hpp"

namespace bpa::server {
namespace {

constexpr std::chrono::milliseconds kLook(50);
constexpr std::chrono::seconds kRetry(2);  // after a server did not start

/// "HOST:PID", for people.
std::string process_name() {
  char host[256] = "host";
  (void)gethostname(host, sizeof host - 1);
  return concat(host, ':', getpid());
}

/// The node's name, unique in a group where the settings name none.
std::string node_name(const ServerOptions& options, const char* role) {
  if (options.node.name != NodeOptions().name) return options.node.name;
  return concat(role, format("_%08x", static_cast<unsigned>(group::new_session() >> 32)));
}

std::string cache_folder(const GroupOptions& options) {
  if (!options.cache.empty()) return options.cache;
  if (const char* cache = std::getenv("XDG_CACHE_HOME")) return concat(cache, "/bpa/models");
  if (const char* home = std::getenv("HOME")) return concat(home, "/.cache/bpa/models");
  or_throw(
      invalid_argument("group.cache is empty, and neither XDG_CACHE_HOME nor HOME is set: "
                       "say where fetched models are kept"));
  return {};
}

class WorkerServer : public Server {
 public:
  WorkerServer(ServerOptions options, const LogHook& log)
      : options_(std::move(options)), log_(log) {
    options_.node.name = node_name(options_, "worker");
    participant_.emplace(or_throw(wire::Participant::create(participant_options(options_, log_))));
    worker_ = or_throw(group::Worker::create(*participant_,
                                             {.group = options_.group.name,
                                              .name = process_name(),
                                              .cache = cache_folder(options_.group),
                                              .threads = options_.detection.threads},
                                             log_));
    bpa::log(log_, LogLevel::info,
             concat("worker ", process_name(), " of group ", options_.group.name));
  }

  Status health() const override {
    const double limit = options_.detection.hang_s;
    return limit == 0 ? Status() : worker_->health(limit);
  }
  void abandon(const Status& why) override {
    bpa::log(log_, LogLevel::error, why.message + "; the worker ends");
  }

 private:
  ServerOptions options_;
  const LogHook log_;
  std::optional<wire::Participant> participant_;
  std::unique_ptr<group::Worker> worker_;
};

class FrontServer : public Server {
 public:
  FrontServer(const ServerOptions& options, std::shared_ptr<Recognition> recognition,
              const LogHook& log)
      : options_(options), recognition_(std::move(recognition)), log_(log) {
    ServerOptions seat = options;
    seat.node.name = node_name(options, "front");
    participant_.emplace(or_throw(wire::Participant::create(participant_options(seat, log_))));
    claims_ = or_throw(group::Claims::create(*participant_, options.group.name, process_name(),
                                             options.group.strength, log_));
    look_ = std::jthread([this](const std::stop_token& stop) { look(stop); });
  }

  ~FrontServer() override {
    look_.request_stop();
    look_.join();
  }

  Status health() const override {
    const auto serving = this->serving();
    return serving ? serving->health() : Status();
  }
  void abandon(const Status& why) override {
    if (const auto serving = this->serving()) serving->abandon(why);
  }

 private:
  std::shared_ptr<Server> serving() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return serving_;
  }

  void look(const std::stop_token& stop) {
    bool waits = false;
    while (!stop.stop_requested()) {
      const bool is_to_serve = claims_->is_to_serve();
      if (is_to_serve && !serving()) {
        begin();
      } else if (!is_to_serve && serving()) {
        serving()->leave_to_another();
        end();
        log(log_, LogLevel::warning, "another front of the group serves: this one waits");
      } else if (!is_to_serve && !std::exchange(waits, true)) {
        log(log_, LogLevel::info, "waits as a front of group " + options_.group.name);
      }
      std::this_thread::sleep_for(kLook);
    }
    end();
  }

  void begin() {
    auto server = Server::create(options_, recognition_, log_);
    if (!server.ok()) {
      log(log_, LogLevel::error, "the front cannot serve: " + server.status().message);
      return std::this_thread::sleep_for(kRetry);
    }
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      serving_ = std::move(server).value();
    }
    claims_->set_serves(true);
    log(log_, LogLevel::info,
        concat("serves as the front of group ", options_.group.name, ", strength ",
               options_.group.strength));
  }

  void end() {
    std::shared_ptr<Server> ended;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      ended.swap(serving_);
    }
    ended.reset();
    claims_->set_serves(false);
  }

  const ServerOptions options_;
  const std::shared_ptr<Recognition> recognition_;
  const LogHook log_;
  std::optional<wire::Participant> participant_;
  std::unique_ptr<group::Claims> claims_;
  mutable std::mutex mutex_;
  std::shared_ptr<Server> serving_;
  std::jthread look_;
};

}  // namespace

std::unique_ptr<Server> make_worker(const ServerOptions& options, const LogHook& log) {
  return std::make_unique<WorkerServer>(options, log);
}

std::unique_ptr<Server> make_front(const ServerOptions& options,
                                   std::shared_ptr<Recognition> recognition, const LogHook& log) {
  return std::make_unique<FrontServer>(options, std::move(recognition), log);
}

}  // namespace bpa::server
