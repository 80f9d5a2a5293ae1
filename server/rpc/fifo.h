// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_FIFO_H_
#define POSESPACE_RPC_FIFO_H_

#include <cstddef>
#include <utility>
#include <vector>

namespace posespace {

// First in, first out, in memory that is kept: std::deque gives its memory back and takes it anew
// as elements pass through.  Elements move when the queue grows.
template <typename T>
class Fifo {
 public:
  bool empty() const { return begin_ == elements_.size(); }
  std::size_t size() const { return elements_.size() - begin_; }
  T& front() { return elements_[begin_]; }
  T& back() { return elements_.back(); }
  T& operator[](std::size_t k) { return elements_[begin_ + k]; }
  const T& operator[](std::size_t k) const { return elements_[begin_ + k]; }

  void push_back(T element) {
    // Rather than grow, move down over at least as many that are gone.
    if (elements_.size() == elements_.capacity() && 2 * begin_ >= elements_.size()) MoveDown();
    elements_.push_back(std::move(element));
  }
  T pop_front() {
    T element = std::move(elements_[begin_++]);
    if (empty()) MoveDown();
    return element;
  }
  // Keeps the first `count`.
  void shorten(std::size_t count) {
    while (size() > count) elements_.pop_back();
    if (empty()) MoveDown();
  }

 private:
  void MoveDown() {
    elements_.erase(elements_.begin(), elements_.begin() + static_cast<std::ptrdiff_t>(begin_));
    begin_ = 0;
  }

  std::vector<T> elements_;
  std::size_t begin_ = 0;
};

}  // namespace posespace

#endif  // POSESPACE_RPC_FIFO_H_
