// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/group/remote_searches.hpp"

#include <algorithm>
#include <chrono>
#include <set>
#include <string>

#include "core/base/concat.hpp"
#include "server/group/messages.hpp"
#include "server/group/session.hpp"

namespace bpa::server::group {
namespace {

namespace msgs = wire::bpa_msgs;
using std::chrono::milliseconds;

// A worker stops by itself when the time of a step is over; its answer is then on its way.
constexpr double kGraceMs = 150, kGraceShare = 0.1;  // by hand
// A worker that searches nothing so long after a step was sent has lost it. By hand: a frame takes
// a second on a link of 20 Mbit/s.
constexpr double kStepLostMs = 5000;

/// The searches for one frame's models, on the workers.
class Searches : public ModelSearches {
 public:
  Searches(std::shared_ptr<Links> links, std::uint64_t search,
           std::shared_ptr<const SharedLibrary> library,
           std::vector<std::shared_ptr<const ObjectModel>> models)
      : links_(std::move(links)),
        search_(search),
        library_(std::move(library)),
        models_(std::move(models)),
        box_(links_->mailboxes.open(search)) {
    found_.resize(models_.size());
    for (std::size_t i = 0; i < models_.size(); ++i) index_of_[models_[i]->number] = i;
  }

  /// The first step, of begin_message().
  Status start(msgs::GroupStep&& begin, std::size_t waiting) {
    begin.front = links_->front;
    begin.search = search_;
    steps_.push_back(std::move(begin));
    const std::vector<std::uint64_t> workers =
        links_->members.wait_for_ready(library_->offer.digest);
    if (workers.empty()) return no_worker();
    const std::size_t frames = links_->members.searches(workers) + waiting + 1;
    std::size_t count;
    {
      const std::lock_guard<std::mutex> lock(links_->cost_mutex);
      SearchCost cost = links_->cost;
      cost.search_ms *= static_cast<double>(models_.size());
      count = workers_for_frame(cost, frames, workers.size());
    }
    std::vector<std::size_t> all(models_.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    give(all, {workers.begin(), workers.begin() + static_cast<std::ptrdiff_t>(count)});
    return {};
  }

  ~Searches() override {
    msgs::GroupStep end = step_of(msgs::GroupStep::kEnd);
    for (const Share& share : shares_) {
      end.share = share.number;
      links_->members.send(share.worker, end);
    }
  }

  void prepared(const SceneFeatures& scene, double took_ms) override {
    pixels_ = scene.image.pixels.size();
    preparation_ms_ = took_ms;
  }

  void score_expected(const Deadline& deadline) override {
    take_candidates(run_competing(step_of(msgs::GroupStep::kExpected), deadline), false);
  }

  void run_round(const RoundPlan& plan) override {
    msgs::GroupStep step = step_of(msgs::GroupStep::kRound);
    step.round = static_cast<std::uint32_t>(plan.number);
    step.part = plan.share;
    step.keypoints.assign(plan.points.keypoints.begin(), plan.points.keypoints.end());
    step.references.assign(plan.points.references.begin(), plan.points.references.end());
    for (std::size_t i = 0; i < models_.size(); ++i) {
      if (plan.left_out[i]) step.left_out.push_back(models_[i]->number);
    }
    step.newly_certain = plan.newly_certain;
    take_candidates(run_competing(std::move(step), plan.deadline), false);
  }

  void finish(const FinalPlan& plan) override {
    msgs::GroupStep step = step_of(msgs::GroupStep::kFinish);
    step.part = plan.share;
    step.newly_certain = plan.newly_certain;
    take_candidates(run(std::move(step), plan.deadline), true);
    measure();
  }

  Status status() const override { return status_; }
  bool late() const override { return late_ || !lost_.empty(); }

  SearchEffort effort() const override {
    SearchEffort sum;
    for (const Share& share : shares_) sum += share.effort;
    return sum;
  }

  std::vector<std::string> lost() const override {
    std::vector<std::string> names;
    for (const std::size_t model : lost_) names.push_back(models_[model]->name);
    return names;
  }

 private:
  struct Share {
    std::uint32_t number = 0;
    std::uint64_t worker = 0;
    std::vector<std::size_t> models;  // indices
    SearchEffort effort;
    double busy_ms = 0;
    bool whole = true;  // it has answered every step
    Stopwatch given;    // since the worker was told
  };

  Status no_worker() const {
    return unavailable(
        "no worker of the group can search: start one with bpa-server --role worker");
  }

  msgs::GroupStep step_of(std::uint8_t kind) const {
    msgs::GroupStep step;
    step.front = links_->front;
    step.search = search_;
    step.kind = kind;
    return step;
  }

  /// Splits these models over the workers, who begin at once.
  void give(const std::vector<std::size_t>& models, const std::vector<std::uint64_t>& workers) {
    std::vector<double> pace;
    for (const std::uint64_t worker : workers) pace.push_back(links_->members.ms_a_model(worker));
    const std::vector<std::size_t> worker_of = split_models(models.size(), pace);
    for (std::size_t w = 0; w < workers.size(); ++w) {
      Share share;
      share.number = next_share_++;
      share.worker = workers[w];
      share.whole = steps_.size() == 1;
      for (std::size_t i = 0; i < models.size(); ++i) {
        if (worker_of[i] == w) share.models.push_back(models[i]);
      }
      if (share.models.empty()) continue;
      for (msgs::GroupStep& step : steps_) {
        step.share = share.number;
        if (step.kind == msgs::GroupStep::kBegin) {
          step.answer_from = static_cast<std::uint32_t>(steps_.size() - 1);
          step.models.clear();
          for (const std::size_t model : share.models) {
            step.models.push_back(models_[model]->number);
          }
        }
        links_->members.send(share.worker, step);
      }
      shares_.push_back(std::move(share));
    }
  }

  /// Runs a step, and a step for each contest of the candidates of all workers.
  std::vector<msgs::GroupAnswer> run_competing(msgs::GroupStep&& step, const Deadline& deadline) {
    std::vector<msgs::GroupAnswer> answers = run(std::move(step), deadline);
    while (!answers.empty() && answers.front().competes) {
      std::vector<detect::Claim> claims;
      for (const msgs::GroupAnswer& answer : answers) {
        std::ranges::transform(answer.claims, std::back_inserter(claims), claim_from);
      }
      const detect::Contest contest = detect::contest_of(std::move(claims), answers.front().most);
      msgs::GroupStep next = step_of(msgs::GroupStep::kContest);
      next.threshold = contest.threshold;
      for (const detect::Claim& claim : contest.claims) next.claims.push_back(to_message(claim));
      answers = run(std::move(next), deadline);
    }
    return answers;
  }

  /// Sends the step to all shares, and waits for their answers: one of each that is not lost.
  std::vector<msgs::GroupAnswer> run(msgs::GroupStep&& step, const Deadline& deadline) {
    if (!status_.ok()) return {};
    step.step = static_cast<std::uint32_t>(steps_.size());
    step.left_ms = milliseconds_left(deadline);
    steps_.push_back(std::move(step));
    for (const Share& share : shares_) {
      steps_.back().share = share.number;
      links_->members.send(share.worker, steps_.back());
    }
    const Stopwatch watch;
    const double patience_ms =
        deadline.never() ? 0 : deadline.milliseconds_left() * (1 + kGraceShare) + kGraceMs;
    std::map<std::uint32_t, msgs::GroupAnswer> answers;  // by share
    double slowest_ms = 0;
    while (true) {
      std::vector<msgs::GroupAnswer> came = wait_for_answers(milliseconds(50));
      for (msgs::GroupAnswer& answer : came) take(std::move(answer), answers);
      const bool give_up = patience_ms > 0 && watch.milliseconds() > patience_ms;
      replace_lost(answers, give_up, watch.milliseconds() > kStepLostMs);
      if (std::ranges::all_of(shares_,
                              [&](const Share& share) { return answers.contains(share.number); })) {
        break;
      }
    }
    std::vector<msgs::GroupAnswer> out;
    for (auto& [share, answer] : answers) {
      slowest_ms = std::max(slowest_ms, answer.busy_ms);
      out.push_back(std::move(answer));
    }
    exchange_ms_ += std::max(0.0, watch.milliseconds() - slowest_ms);
    return out;
  }

  std::vector<msgs::GroupAnswer> wait_for_answers(milliseconds most) {
    std::unique_lock<std::mutex> lock(box_->mutex);
    box_->changed.wait_for(lock, most, [&] { return !box_->answers.empty(); });
    return std::exchange(box_->answers, {});
  }

  void take(msgs::GroupAnswer&& answer, std::map<std::uint32_t, msgs::GroupAnswer>& answers) {
    const auto share = std::ranges::find(shares_, answer.share, &Share::number);
    if (share == shares_.end()) return;  // its models were given to another
    if (answer.status.code != 0) {
      log(links_->members.hook(), LogLevel::warning,
          concat("worker ", links_->members.name_of(share->worker), ": ", answer.status.message));
      refused_.insert(share->worker);
      return;
    }
    if (answer.step + 1 != steps_.size()) return;
    share->busy_ms += answer.busy_ms;
    std::size_t i = 0;
    for (const auto& [name, count] : kEffortCounts) {
      if (i < answer.effort.size()) share->effort.*count = answer.effort[i++];
    }
    late_ = late_ || answer.late;
    answers[answer.share] = std::move(answer);
  }

  /// Gives the models of lost workers to others; with `give_up`, those that have not answered are
  /// lost, too, and their models stay unsearched. With `settled`, the step was sent so long ago
  /// that a worker that searches nothing has lost it.
  void replace_lost(const std::map<std::uint32_t, msgs::GroupAnswer>& answers, bool give_up,
                    bool settled) {
    std::vector<std::size_t> open;
    std::erase_if(shares_, [&](const Share& share) {
      if (answers.contains(share.number)) return false;
      // Not asked again: on a slow link one more frame would take the place of the first.
      if (settled && share.given.milliseconds() > kStepLostMs &&
          links_->members.rests(share.worker)) {
        refused_.insert(share.worker);
      }
      const bool gone = refused_.contains(share.worker) || links_->members.is_lost(share.worker);
      if (!gone && !give_up) return false;
      open.insert(open.end(), share.models.begin(), share.models.end());
      msgs::GroupStep end = step_of(msgs::GroupStep::kEnd);
      end.share = share.number;
      links_->members.send(share.worker, end);
      return true;
    });
    if (open.empty()) return;
    std::vector<std::uint64_t> workers = links_->members.ready(library_->offer.digest);
    const auto refused = [&](std::uint64_t worker) { return refused_.contains(worker); };
    std::erase_if(workers, refused);
    if (workers.empty()) workers = links_->members.reserve(library_->offer.digest);
    std::erase_if(workers, refused);
    if (give_up || workers.empty()) {
      lost_.insert(lost_.end(), open.begin(), open.end());
      log(links_->members.hook(), LogLevel::warning,
          concat(open.size(), " of ", models_.size(), " models are not searched: their workers ",
                 give_up ? "did not answer in time" : "were lost, and no other is there"));
      if (shares_.empty()) {
        status_ = give_up ? Status(StatusCode::timeout, "no worker answered in time") : no_worker();
      }
      return;
    }
    log(links_->members.hook(), LogLevel::info,
        concat(open.size(), " models of lost workers are searched by others"));
    give(open, workers);
  }

  void take_candidates(std::vector<msgs::GroupAnswer>&& answers, bool all) {
    if (all) {
      for (detect::Candidates& of_model : found_) of_model.clear();
    }
    for (msgs::GroupAnswer& answer : answers) {
      for (msgs::GroupCandidate& message : answer.candidates) {
        const auto index = index_of_.find(message.model);
        if (index == index_of_.end()) continue;
        const ObjectModel& model = *models_[index->second];
        Result<detect::Candidate> candidate = candidate_from(std::move(message), model, pixels_);
        if (!candidate.ok()) {
          status_ = candidate.status();
          return;
        }
        found_[index->second].push_back(std::move(candidate).value());
      }
    }
  }

  void measure() {
    double busy_ms = 0, models = 0;
    for (const Share& share : shares_) {
      if (!share.whole) continue;
      const auto searched = static_cast<double>(share.models.size());
      links_->members.measured(share.worker, share.busy_ms / searched);
      busy_ms += share.busy_ms;
      models += searched;
    }
    if (models == 0) return;
    const std::lock_guard<std::mutex> lock(links_->cost_mutex);
    links_->cost.add({preparation_ms_, busy_ms / models, exchange_ms_});
  }

  const std::shared_ptr<Links> links_;
  const std::uint64_t search_;
  const std::shared_ptr<const SharedLibrary> library_;
  const std::vector<std::shared_ptr<const ObjectModel>> models_;
  std::map<int, std::size_t> index_of_;  // by number
  const std::shared_ptr<Mailboxes::Box> box_;
  std::size_t pixels_ = 0;
  double preparation_ms_ = 0, exchange_ms_ = 0;
  std::vector<msgs::GroupStep> steps_;  // all so far, for a worker that takes over
  std::vector<Share> shares_;
  std::uint32_t next_share_ = 0;
  std::set<std::uint64_t> refused_;  // workers that cannot
  std::vector<std::size_t> lost_;    // models
  Status status_;                    // why no step is sent any more
  bool late_ = false;
};

}  // namespace

Result<std::unique_ptr<ModelSearches>> make_remote_searches(
    std::shared_ptr<Links> links, std::uint64_t search,
    std::shared_ptr<const SharedLibrary> library,
    std::vector<std::shared_ptr<const ObjectModel>> models, msgs::GroupStep&& begin,
    std::size_t waiting) {
  auto searches =
      std::make_unique<Searches>(std::move(links), search, std::move(library), std::move(models));
  if (Status status = searches->start(std::move(begin), waiting); !status.ok()) return status;
  return std::unique_ptr<ModelSearches>(std::move(searches));
}

}  // namespace bpa::server::group
