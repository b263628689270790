#include "tactus/panel/panel_state.h"

#include <utility>

namespace tactus {
namespace {

constexpr std::size_t kBinsAnEvent = 40;
constexpr std::size_t kShownBins = 1200;
constexpr double kShown_s = 30.0;
constexpr std::size_t kShownContacts = 50;
constexpr std::size_t kContactsWithTrace = 8;

}  // namespace

Json PanelState::update(const Json& state, const LogNews& news) {
  Json event = Json::object();
  const bool begins = state_.is_null() || state_.at("run") != state.at("run");
  if (begins) *this = {};
  if (begins) event["begins"] = true;
  if (state != state_) event["state"] = state_ = state;
  links_ = news.links;
  if (Json force = takeForce(news); !force.is_null()) event["force"] = std::move(force);
  for (const Json& contact : news.contacts) contacts_.push_back(contact);
  while (contacts_.size() > kShownContacts) contacts_.pop_front();
  for (std::size_t i = 0; i + kContactsWithTrace < contacts_.size(); ++i)
    contacts_[i].erase("trace");
  if (!news.contacts.empty()) event["contacts"] = news.contacts;
  const bool is_now = news.is_live && news.problem.empty();
  Json lasting = is_now ? news.lasting : std::vector<Json>{};
  if (lasting != lasting_) event["lasting"] = lasting_ = std::move(lasting);
  return event.empty() ? Json() : event;
}

/// What is past is told once all of it was read.
Json PanelState::takeForce(const LogNews& news) {
  past_.insert(past_.end(), news.bins.begin(), news.bins.end());
  while (!past_.empty() && past_.front().from_s < past_.back().to_s - kShown_s) past_.pop_front();
  const bool was_live = std::exchange(is_live_, news.is_live);
  if (!is_live_ || (was_live && news.bins.empty())) return nullptr;
  return was_live ? forceJson(fewerBins(news.bins, kBinsAnEvent), 0, modules()) : pastForce();
}

Json PanelState::pastForce() const {
  const std::vector<ForceBin> past(past_.begin(), past_.end());
  return forceJson(fewerBins(past, kShownBins), 0, modules());
}

Json PanelState::all() const {
  return {{"begins", true},
          {"state", state_},
          {"force", pastForce()},
          {"contacts", contacts_},
          {"lasting", lasting_}};
}

}  // namespace tactus
