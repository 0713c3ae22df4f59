#include "calibrato/base/progress.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <utility>

#include "calibrato/base/progress_line.h"

namespace calibrato {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kRedrawInterval{100};

std::atomic<bool> silenced{false};

// One column is left free: a terminal wraps when its last one is written.
size_t TerminalWidth() {
  winsize size{};
  const bool is_known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
  return is_known ? size.ws_col - 1U : 79U;
}

// A bar is a courtesy: where the terminal is gone, the work goes on.
void Print(const std::string& text) {
  const ssize_t written = write(STDERR_FILENO, text.data(), text.size());
  static_cast<void>(written);
}

}  // namespace

struct Progress::Impl {
  std::mutex mutex;
  ProgressState state;
  bool is_terminal = false;
  bool is_drawn = false;
  Clock::time_point start = Clock::now();
  Clock::time_point last_draw = start - kRedrawInterval;
};

Progress::Progress(std::string title, int64_t total) : impl_(std::make_unique<Impl>()) {
  impl_->state.title = std::move(title);
  impl_->state.total = total;
  impl_->is_terminal = isatty(STDERR_FILENO) == 1;
}

Progress::~Progress() {
  if (impl_->is_drawn) Print("\r\033[K");
}

void Progress::Advance(int64_t count, const std::string& remark) {
  const std::lock_guard lock(impl_->mutex);
  impl_->state.done += count;
  if (!remark.empty()) impl_->state.remark = remark;
  if (!impl_->is_terminal || silenced) return;
  const Clock::time_point now = Clock::now();
  if (now - impl_->last_draw < kRedrawInterval) return;
  impl_->last_draw = now;
  impl_->state.elapsed_s = std::chrono::duration<double>(now - impl_->start).count();
  std::string text = "\r";
  text += FormatProgressLine(impl_->state, TerminalWidth());
  text += "\033[K";
  Print(text);
  impl_->is_drawn = true;
}

void Progress::Silence() { silenced = true; }

}  // namespace calibrato
