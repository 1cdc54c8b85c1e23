// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/group/members.hpp"

#include <algorithm>

#include "core/base/concat.hpp"
#include "server/group/session.hpp"

namespace bpa::server::group {
namespace {

namespace msgs = wire::bpa_msgs;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kMaxWorkers = 1024;
constexpr auto kForgetAfter = std::chrono::seconds(30);  // of silence

}  // namespace

void Members::heard(msgs::GroupWorker&& said) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (members_.size() >= kMaxWorkers && !members_.contains(said.worker)) return;
  Member& member = members_[said.worker];
  if (member.lost) log(log_, LogLevel::info, concat("worker ", said.name, " is back"));
  if (said.version != BPA_VERSION && member.said.version != said.version) {
    log(log_, LogLevel::warning,
        concat("worker ", said.name, " is not used: its version is ", said.version, ", not ",
               BPA_VERSION));
  }
  if (!said.problem.empty() && said.problem != member.said.problem) {
    log(log_, LogLevel::warning, concat("worker ", said.name, ": ", said.problem));
  }
  member.lost = false;
  if (said.searches > 0 || !member.tasks) member.resting = Clock::now();
  member.heard = Clock::now();
  member.said = std::move(said);
}

void Members::welcome() {
  std::vector<std::uint64_t> fresh;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const auto& [id, member] : members_) {
      if (!member.tasks) fresh.push_back(id);
    }
  }
  for (const std::uint64_t id : fresh) {
    auto made = TaskPublisher::create(participant_, topics_.tasks(id), {qos()});
    if (!made.ok()) {
      log(log_, LogLevel::error, made.status().message);
      continue;
    }
    auto tasks = std::make_shared<TaskPublisher>(std::move(made).value());
    const std::lock_guard<std::mutex> lock(mutex_);
    Member& member = members_[id];
    member.tasks = std::move(tasks);
    log(log_, LogLevel::info,
        concat("worker ", member.said.name, " joined, ", member.said.threads, " threads"));
  }
}

void Members::look() {
  // Closed after the mutex is free: closing waits for callbacks, which take it.
  std::vector<std::shared_ptr<TaskPublisher>> forgotten;
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto now = Clock::now();
  for (auto& [id, member] : members_) {
    if (member.lost || now - member.heard < kSilence) continue;
    member.lost = true;
    log(log_, LogLevel::warning,
        concat("worker ", member.said.name, " is lost: it was silent for ", kSilence.count(),
               " ms"));
  }
  std::erase_if(members_, [&](const auto& entry) {
    const Member& member = entry.second;
    if (now - member.heard <= kForgetAfter || !member.searches.empty()) return false;
    forgotten.push_back(member.tasks);
    return true;
  });
}

bool Members::is_lost(std::uint64_t worker) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = members_.find(worker);
  return found == members_.end() || found->second.lost;
}

bool Members::rests(std::uint64_t worker) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = members_.find(worker);
  return found == members_.end() || Clock::now() - found->second.resting > kSilence;
}

std::vector<std::uint64_t> Members::ready(const std::string& library) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<std::uint64_t> out;
  for (const auto& [id, member] : members_) {
    if (can_search(member, library)) out.push_back(id);
  }
  std::ranges::stable_sort(out, {},
                           [&](std::uint64_t id) { return members_.at(id).searches.size(); });
  return out;
}

std::size_t Members::searches(const std::vector<std::uint64_t>& workers) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::set<std::uint64_t> running;
  for (const std::uint64_t id : workers) {
    if (const auto found = members_.find(id); found != members_.end()) {
      running.insert(found->second.searches.begin(), found->second.searches.end());
    }
  }
  return running.size();
}

double Members::ms_a_model(std::uint64_t worker) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = members_.find(worker);
  if (found != members_.end() && found->second.ms_a_model > 0) return found->second.ms_a_model;
  double sum = 0;
  int measured = 0;
  for (const auto& [id, member] : members_) {
    sum += member.ms_a_model;
    measured += member.ms_a_model > 0;
  }
  return measured > 0 ? sum / measured : 1;
}

void Members::measured(std::uint64_t worker, double ms_a_model) {
  constexpr double kOfNew = 0.3;  // by hand
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = members_.find(worker);
  if (found == members_.end()) return;
  double& mean = found->second.ms_a_model;
  mean = mean > 0 ? mean + kOfNew * (ms_a_model - mean) : ms_a_model;
}

void Members::send(std::uint64_t worker, const msgs::GroupTask& task) {
  std::shared_ptr<TaskPublisher> tasks;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = members_.find(worker);
    if (found == members_.end()) return;
    found->second.searches.insert(task.search);
    tasks = found->second.tasks;
  }
  if (!tasks) return;
  const Status status = tasks->publish(task);
  if (!status.ok()) log(log_, LogLevel::warning, status.message);
}

void Members::done(std::uint64_t worker, std::uint64_t search) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = members_.find(worker);
  if (found != members_.end()) found->second.searches.erase(search);
}

bool Members::any_lacks(const std::string& library) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return std::ranges::any_of(members_, [&](const auto& entry) {
    const Member& member = entry.second;
    return !member.lost && std::ranges::count(member.said.libraries, library) == 0;
  });
}

std::string Members::name_of(std::uint64_t worker) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = members_.find(worker);
  return found == members_.end() ? "unknown" : found->second.said.name;
}

std::vector<WorkerState> Members::states(const std::string& library) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<WorkerState> out;
  for (const auto& [id, member] : members_) {
    WorkerState state{.name = member.said.name,
                      .ready = can_search(member, library),
                      .problem = member.said.problem,
                      .ms_a_model = member.ms_a_model,
                      .searches = static_cast<int>(member.searches.size())};
    if (member.said.version != BPA_VERSION) state.problem = "version " + member.said.version;
    if (member.lost) state.problem = "lost";
    if (!state.ready && state.problem.empty()) state.problem = "fetches models";
    out.push_back(std::move(state));
  }
  return out;
}

bool Members::can_search(const Member& member, const std::string& library) {
  return !member.lost && member.said.version == BPA_VERSION &&
         std::ranges::count(member.said.libraries, library) > 0 && member.tasks &&
         member.tasks->matched_count() > 0;
}

}  // namespace bpa::server::group
