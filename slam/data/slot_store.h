#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace planecast::slam {

/// Values by dense id, iterated in the order of their ids. Erased ids are never given out again, so
/// that an id names the same thing for the whole run. Copyable: a copy is a snapshot.
template <typename T>
class SlotStore {
 public:
  int next_id() const { return static_cast<int>(slots_.size()); }

  /// Makes the ids below `next_id` given out, erased where nothing is stored.
  void reserve_ids(int next_id) {
    if (next_id > this->next_id()) slots_.resize(static_cast<std::size_t>(next_id));
  }

  /// Stores `value` under `value.id`, which must be next_id() or an erased or unused id below it.
  T& put(T value) {
    const std::size_t index = static_cast<std::size_t>(value.id);
    if (index >= slots_.size()) slots_.resize(index + 1);
    if (!slots_[index]) ++count_;
    slots_[index].emplace(std::move(value));
    return *slots_[index];
  }
  void erase(int id) {
    if (find(id) == nullptr) return;
    slots_[static_cast<std::size_t>(id)].reset();
    --count_;
  }

  T* find(int id) {
    return id >= 0 && id < next_id() && slots_[static_cast<std::size_t>(id)]
               ? &*slots_[static_cast<std::size_t>(id)]
               : nullptr;
  }
  const T* find(int id) const { return const_cast<SlotStore*>(this)->find(id); }
  /// Precondition: the id is alive.
  T& at(int id) { return *slots_[static_cast<std::size_t>(id)]; }
  const T& at(int id) const { return *slots_[static_cast<std::size_t>(id)]; }
  bool contains(int id) const { return find(id) != nullptr; }
  std::size_t size() const { return count_; }
  bool empty() const { return count_ == 0; }

  template <typename Slots, typename Value>
  class Iterator {
   public:
    Iterator(Slots* slots, std::size_t index) : slots_(slots), index_(index) { skip(); }
    Value& operator*() const { return *(*slots_)[index_]; }
    Value* operator->() const { return &*(*slots_)[index_]; }
    Iterator& operator++() {
      ++index_;
      skip();
      return *this;
    }
    bool operator!=(const Iterator& other) const { return index_ != other.index_; }
    bool operator==(const Iterator& other) const { return index_ == other.index_; }

   private:
    void skip() {
      while (index_ < slots_->size() && !(*slots_)[index_]) ++index_;
    }
    Slots* slots_;
    std::size_t index_;
  };

  using Slots = std::vector<std::optional<T>>;
  auto begin() { return Iterator<Slots, T>(&slots_, 0); }
  auto end() { return Iterator<Slots, T>(&slots_, slots_.size()); }
  auto begin() const { return Iterator<const Slots, const T>(&slots_, 0); }
  auto end() const { return Iterator<const Slots, const T>(&slots_, slots_.size()); }

 private:
  Slots slots_;
  std::size_t count_ = 0;
};

}  // namespace planecast::slam
