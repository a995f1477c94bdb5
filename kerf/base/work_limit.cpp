#include "kerf/base/work_limit.h"

#include <algorithm>
#include <utility>

namespace kerf {
namespace {

thread_local const WorkLimit* current = nullptr;

}  // namespace

const WorkLimit* current_limit() { return current; }

LimitScope::LimitScope(const WorkLimit* limit) : previous_(std::exchange(current, limit)) {}
LimitScope::~LimitScope() { current = previous_; }

ProgressPart::ProgressPart(const WorkLimit& limit, double share) : meter_(limit.meter) {
  if (meter_ == nullptr) return;
  const std::lock_guard lock(meter_->mutex_);
  until_ = meter_->until_;
  meter_->from_ = meter_->share();
  meter_->until_ = meter_->from_ + std::clamp(share, 0.0, 1.0) * (until_ - meter_->from_);
  meter_->units_ = 0;
  meter_->done_ = 0;
}

ProgressPart::~ProgressPart() {
  if (meter_ == nullptr) return;
  const std::lock_guard lock(meter_->mutex_);
  meter_->from_ = meter_->until_;
  meter_->until_ = until_;
  meter_->units_ = 0;
  meter_->done_ = 0;
}

HeldBytes::HeldBytes() : limit_(current), meter_(current != nullptr ? current->meter : nullptr) {}

HeldBytes::HeldBytes(HeldBytes&& other) noexcept
    : limit_(other.limit_), meter_(other.meter_), bytes_(other.bytes_.exchange(0)) {}

HeldBytes& HeldBytes::operator=(HeldBytes&& other) noexcept {
  release();
  limit_ = other.limit_;
  meter_ = other.meter_;
  bytes_ = other.bytes_.exchange(0);
  return *this;
}

void HeldBytes::set(size_t bytes) {
  const size_t before = bytes_;
  bytes > before ? add(bytes - before) : subtract(before - bytes);
}

void HeldBytes::add(size_t bytes) {
  if (meter_ == nullptr) return;
  const size_t held = meter_->hold(bytes);
  if (held > limit_->bytes) {
    meter_->release(bytes);
    limit_->check(held);
  }
  bytes_ += bytes;
}

void HeldBytes::subtract(size_t bytes) {
  if (meter_ == nullptr) return;
  meter_->release(bytes);
  bytes_ -= bytes;
}

}  // namespace kerf
