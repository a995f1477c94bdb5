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
    : limit_(other.limit_), meter_(other.meter_), bytes_(std::exchange(other.bytes_, 0)) {}

HeldBytes& HeldBytes::operator=(HeldBytes&& other) noexcept {
  release();
  limit_ = other.limit_;
  meter_ = other.meter_;
  bytes_ = std::exchange(other.bytes_, 0);
  return *this;
}

void HeldBytes::set(size_t bytes) {
  if (meter_ == nullptr) return;
  if (bytes <= bytes_) {
    meter_->release(bytes_ - bytes);
    bytes_ = bytes;
    return;
  }
  const size_t held = meter_->hold(bytes - bytes_);
  bytes_ = bytes;
  if (held <= limit_->bytes) return;
  release();
  limit_->check(held);
}

void HeldBytes::release() {
  if (meter_ != nullptr) meter_->release(std::exchange(bytes_, 0));
}

}  // namespace kerf
