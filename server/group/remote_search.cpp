// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/group/remote_search.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <set>
#include <string>

#include "core/base/concat.hpp"
#include "core/base/stopwatch.hpp"
#include "server/group/messages.hpp"
#include "server/group/split.hpp"

namespace bpa::server::group {
namespace {

namespace msgs = wire::bpa_msgs;
using std::chrono::milliseconds;

// A worker stops by itself when the time is over; its answer is then on its way. By hand.
constexpr double kGraceMs = 150, kGraceShare = 0.1;
// A worker that searches nothing so long after a task was sent has lost it. By hand: a frame takes
// a second on a link of 20 Mbit/s.
constexpr double kTaskLostMs = 5000;

class Search {
 public:
  Search(std::shared_ptr<Links> links, RemoteTask task, const Models& models)
      : links_(std::move(links)),
        task_(std::move(task)),
        models_(models),
        box_(links_->mailboxes.open(task_.number)),
        found_(models_.size()) {
    for (std::size_t i = 0; i < models_.size(); ++i) {
      open_.push_back(i);
      result_.missed.push_back({models_[i]->name, 0});
    }
  }

  ~Search() {
    for (const std::uint64_t worker : used_) links_->members.done(worker, task_.number);
  }

  void start() {
    message_ = task_message(task_.frame, task_.request, task_.detector.options(), *task_.library);
    message_.front = links_->front;
    message_.search = task_.number;
    std::vector<std::uint64_t> workers = usable();
    if (workers.empty()) return;
    const std::size_t frames = links_->members.searches(workers) + task_.waiting + 1;
    workers.resize(workers_for_frame(frames, workers.size()));
    give(workers);
  }

  Result<SearchResult> finish(std::size_t pixels) {
    while (!shares_.empty() || !open_.empty()) {
      for (msgs::GroupAnswer& answer : wait_for_answers()) take(std::move(answer), pixels);
      take_from_lost();
      if (is_late()) break;
      if (open_.empty()) continue;
      if (const std::vector<std::uint64_t> workers = usable(); !workers.empty()) {
        give(workers);
      } else if (Status status = search_here(); !status.ok()) {
        return status;
      }
    }
    return joined();
  }

 private:
  struct Share {
    std::uint32_t number = 0;
    std::uint64_t worker = 0;
    std::vector<std::size_t> models;  // indices
    Stopwatch given;
  };

  std::vector<std::uint64_t> usable() const {
    std::vector<std::uint64_t> workers = links_->members.ready(task_.library->offer.digest);
    std::erase_if(workers, [&](std::uint64_t worker) { return refused_.contains(worker); });
    return workers;
  }

  Models models_of(const std::vector<std::size_t>& indices) const {
    Models out;
    for (const std::size_t i : indices) out.push_back(models_[i]);
    return out;
  }

  double milliseconds_left() const {
    constexpr double kLeast = 1;  // 0 stands for no limit
    const double budget = task_.request.budget_ms;
    return budget > 0 ? std::max(kLeast, budget - watch_.milliseconds()) : 0;
  }

  bool is_late() const {
    const double budget = task_.request.budget_ms;
    return budget > 0 && watch_.milliseconds() > budget * (1 + kGraceShare) + kGraceMs;
  }

  /// Splits the open models over these workers, who begin at once.
  void give(const std::vector<std::uint64_t>& workers) {
    std::vector<double> pace;
    for (const std::uint64_t worker : workers) pace.push_back(links_->members.ms_a_model(worker));
    const std::vector<std::size_t> worker_of = split_models(open_.size(), pace);
    message_.budget_ms = milliseconds_left();
    for (std::size_t w = 0; w < workers.size(); ++w) {
      Share share{next_share_++, workers[w], {}, {}};
      message_.share = share.number;
      message_.models.clear();
      for (std::size_t i = 0; i < open_.size(); ++i) {
        if (worker_of[i] != w) continue;
        share.models.push_back(open_[i]);
        message_.models.push_back(models_[open_[i]]->number);
      }
      if (share.models.empty()) continue;
      used_.insert(share.worker);
      links_->members.send(share.worker, message_);
      shares_.push_back(std::move(share));
    }
    open_.clear();
  }

  std::vector<msgs::GroupAnswer> wait_for_answers() {
    std::unique_lock<std::mutex> lock(box_->mutex);
    const milliseconds most(shares_.empty() ? 0 : 50);
    box_->changed.wait_for(lock, most, [&] { return !box_->answers.empty(); });
    return std::exchange(box_->answers, {});
  }

  void take(msgs::GroupAnswer&& answer, std::size_t pixels) {
    const auto share = std::ranges::find(shares_, answer.share, &Share::number);
    if (share == shares_.end() || share->worker != answer.worker) return;  // given to another
    const double busy_ms = answer.busy_ms;
    Result<SearchResult> found = result_from(std::move(answer), models_of(share->models), pixels);
    if (found.ok()) {
      links_->members.measured(share->worker, std::max(0.0, busy_ms - found->preparation_ms) /
                                                  static_cast<double>(share->models.size()));
      add(std::move(found).value(), share->models);
    } else {
      log(links_->members.hook(), LogLevel::warning,
          concat("worker ", links_->members.name_of(share->worker), ": ", found.status().message));
      refused_.insert(share->worker);
      std::ranges::copy(share->models, std::back_inserter(open_));
    }
    shares_.erase(share);
  }

  void add(SearchResult found, const std::vector<std::size_t>& models) {
    for (std::size_t i = 0; i < models.size(); ++i) {
      result_.missed[models[i]].expected = found.missed[i].expected;
    }
    for (detect::Candidate& candidate : found.candidates) {
      const auto model = std::ranges::find(models_, candidate.model, &Models::value_type::get);
      found_[static_cast<std::size_t>(model - models_.begin())].push_back(std::move(candidate));
    }
    result_.effort += found.effort;
    result_.cut = result_.cut || found.cut;
  }

  /// Opens the models of workers that are lost.
  void take_from_lost() {
    const std::size_t before = open_.size();
    std::erase_if(shares_, [&](const Share& share) {
      const Members& members = links_->members;
      const bool forgot = share.given.milliseconds() > kTaskLostMs && members.rests(share.worker);
      if (!forgot && !members.is_lost(share.worker)) return false;
      // On a slow link one more frame would take the place of the first.
      refused_.insert(share.worker);
      std::ranges::copy(share.models, std::back_inserter(open_));
      return true;
    });
    if (open_.size() == before) return;
    log(links_->members.hook(), LogLevel::info,
        concat(open_.size() - before, " models of lost workers are searched by others"));
  }

  /// The open models.
  Status search_here() {
    DetectRequest request = task_.request;
    request.on_round = {};
    request.budget_ms = milliseconds_left();
    request.models.clear();
    for (const std::size_t i : open_) request.models.push_back(models_[i]->name);
    Result<SearchResult> found = task_.detector.search(task_.frame, request);
    if (!found.ok()) return found.status();
    add(std::move(found).value(), std::exchange(open_, {}));
    return {};
  }

  Result<SearchResult> joined() {
    for (const Share& share : shares_) std::ranges::copy(share.models, std::back_inserter(open_));
    if (open_.size() == models_.size()) {
      return Status(StatusCode::timeout, "no worker answered in time");
    }
    if (!open_.empty()) {
      log(links_->members.hook(), LogLevel::warning,
          concat(open_.size(), " of ", models_.size(),
                 " models are not searched: their workers did not answer in time"));
    }
    std::ranges::sort(open_);
    for (const std::size_t i : open_) result_.not_searched.push_back(models_[i]->name);
    result_.cut = result_.cut || !open_.empty();
    for (detect::Candidates& of_model : found_) {
      std::ranges::move(of_model, std::back_inserter(result_.candidates));
    }
    return std::move(result_);
  }

  const std::shared_ptr<Links> links_;
  const RemoteTask task_;
  const Models models_;
  const std::shared_ptr<Mailboxes::Box> box_;
  const Stopwatch watch_;
  msgs::GroupTask message_;        // what all shares have
  std::vector<std::size_t> open_;  // models that nobody searches
  std::vector<Share> shares_;      // that are searched
  std::uint32_t next_share_ = 0;
  std::set<std::uint64_t> refused_, used_;  // workers
  std::vector<detect::Candidates> found_;   // of each model
  SearchResult result_;
};

}  // namespace

RemoteSearch remote_search(std::shared_ptr<Links> links, RemoteTask task) {
  return [links = std::move(links), task = std::move(task)](const Models& models) {
    auto search = std::make_shared<Search>(links, task, models);
    search->start();
    return Result<RemoteResult>(
        [search = std::move(search)](std::size_t pixels) { return search->finish(pixels); });
  };
}

}  // namespace bpa::server::group
