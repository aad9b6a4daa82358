/* mps/ranges.hpp - fields of particles as ranges of C++17 and C++20: one component, or the rows of
 * all components. Included by mps/mps.hpp, whose arrays make them:
 *
 *   for (double vx : velocity.column(0)) ...
 *   for (auto v : velocity.rows()) speed = std::max(speed, std::hypot(v[0], v[1]));
 *   std::ranges::max(velocity.column(1))     // C++20: views, random access
 *
 * A range is two pointers: valid as long as its field (array::stale). SPDX-License-Identifier:
 * BSD-3-Clause */
#ifndef LIBMPS_RANGES_HPP
#define LIBMPS_RANGES_HPP

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <type_traits>
#include <utility>
#if __cplusplus >= 202002L &&                                                                      \
    !(defined(__clang__) && __clang_major__ < 16) /* cannot read libstdc++'s */
#define MPS_CPP_RANGES
#include <ranges>
#endif

namespace mps {
inline namespace v1 {

/** Iterator over one component of a field, in the present order of the particles: random access. */
template <class V> class strided {
public:
  using iterator_category = std::random_access_iterator_tag;
  using value_type = std::remove_cv_t<V>;
  using difference_type = std::ptrdiff_t;
  using pointer = V *;
  using reference = V &;
  strided() noexcept = default;
  strided(V *first, int64_t stride) noexcept : at_(first), stride_(stride) {}
  reference operator*() const noexcept { return *at_; }
  pointer operator->() const noexcept { return at_; }
  reference operator[](difference_type n) const noexcept { return at_[n * stride_]; }
  strided &operator+=(difference_type n) noexcept { return at_ += n * stride_, *this; }
  strided &operator-=(difference_type n) noexcept { return at_ -= n * stride_, *this; }
  strided &operator++() noexcept { return *this += 1; }
  strided &operator--() noexcept { return *this -= 1; }
  strided operator++(int) noexcept { return std::exchange(*this, *this + 1); }
  strided operator--(int) noexcept { return std::exchange(*this, *this - 1); }
  friend strided operator+(strided i, difference_type n) noexcept { return i += n; }
  friend strided operator+(difference_type n, strided i) noexcept { return i += n; }
  friend strided operator-(strided i, difference_type n) noexcept { return i -= n; }
  friend difference_type operator-(strided a, strided b) noexcept {
    return a.stride_ ? (a.at_ - b.at_) / a.stride_ : 0;
  }
  friend bool operator==(strided a, strided b) noexcept { return a.at_ == b.at_; }
  friend bool operator!=(strided a, strided b) noexcept { return a.at_ != b.at_; }
  friend bool operator<(strided a, strided b) noexcept { return b - a > 0; }
  friend bool operator>(strided a, strided b) noexcept { return b < a; }
  friend bool operator<=(strided a, strided b) noexcept { return !(b < a); }
  friend bool operator>=(strided a, strided b) noexcept { return !(a < b); }

private:
  V *at_ = nullptr;
  difference_type stride_ = 1;
};

/** One component of a field as a range: for (double &v : field.column(0)) ..., std::max_element.
 *  Valid as long as its field. */
template <class V> class column_range {
public:
  column_range() noexcept = default;
  column_range(V *first, int64_t stride, int64_t size) noexcept
      : first_(first, stride), size_(size) {}
  strided<V> begin() const noexcept { return first_; }
  strided<V> end() const noexcept { return first_ + size_; }
  int64_t size() const noexcept { return size_; }
  V &operator[](int64_t i) const noexcept { return first_[i]; }

private:
  strided<V> first_;
  int64_t size_ = 0;
};

/** The components of one particle: row[0], row[1] ..., for (double &x : row). */
template <class V> using row = column_range<V>;

/** Iterator over the rows of a field; a row is made when it is looked at, so this is an input
 * iterator to C++17's algorithms and one of random access to C++20's. */
template <class V> class row_iterator {
public:
  using iterator_concept = std::random_access_iterator_tag;
  using iterator_category = std::input_iterator_tag;
  using value_type = row<V>;
  using difference_type = std::ptrdiff_t;
  using pointer = void;
  using reference = row<V>;
  row_iterator() noexcept = default;
  row_iterator(V *first, int64_t stride, int64_t inner, int64_t components) noexcept
      : at_(first), stride_(stride), inner_(inner), components_(components) {}
  reference operator*() const noexcept { return (*this)[0]; }
  reference operator[](difference_type n) const noexcept {
    return {at_ + (number_ + n) * stride_, inner_, components_};
  }
  row_iterator &operator+=(difference_type n) noexcept { return number_ += n, *this; }
  row_iterator &operator-=(difference_type n) noexcept { return number_ -= n, *this; }
  row_iterator &operator++() noexcept { return *this += 1; }
  row_iterator &operator--() noexcept { return *this -= 1; }
  row_iterator operator++(int) noexcept { return std::exchange(*this, *this + 1); }
  row_iterator operator--(int) noexcept { return std::exchange(*this, *this - 1); }
  friend row_iterator operator+(row_iterator i, difference_type n) noexcept { return i += n; }
  friend row_iterator operator+(difference_type n, row_iterator i) noexcept { return i += n; }
  friend row_iterator operator-(row_iterator i, difference_type n) noexcept { return i -= n; }
  friend difference_type operator-(row_iterator a, row_iterator b) noexcept {
    return a.number_ - b.number_;
  }
  friend bool operator==(row_iterator a, row_iterator b) noexcept { return a.number_ == b.number_; }
  friend bool operator!=(row_iterator a, row_iterator b) noexcept { return a.number_ != b.number_; }
  friend bool operator<(row_iterator a, row_iterator b) noexcept { return a.number_ < b.number_; }
  friend bool operator>(row_iterator a, row_iterator b) noexcept { return b < a; }
  friend bool operator<=(row_iterator a, row_iterator b) noexcept { return !(b < a); }
  friend bool operator>=(row_iterator a, row_iterator b) noexcept { return !(a < b); }

private:
  V *at_ = nullptr;
  int64_t stride_ = 1, inner_ = 1, components_ = 0;
  difference_type number_ = 0;
};

/** The particles of a field, in present order, each as a row of its components. */
template <class V> class row_range {
public:
  row_range() noexcept = default;
  row_range(V *first, const int64_t *stride, int64_t size, int64_t components) noexcept
      : first_(first, stride[0], stride[1], components), size_(size) {}
  row_iterator<V> begin() const noexcept { return first_; }
  row_iterator<V> end() const noexcept { return first_ + size_; }
  int64_t size() const noexcept { return size_; }
  row<V> operator[](int64_t i) const noexcept { return first_[i]; }

private:
  row_iterator<V> first_;
  int64_t size_ = 0;
};

} // namespace v1
} // namespace mps

#if defined(MPS_CPP_RANGES) /* both are views, and their iterators outlive them */
template <class V> inline constexpr bool std::ranges::enable_view<mps::column_range<V>> = true;
template <class V>
inline constexpr bool std::ranges::enable_borrowed_range<mps::column_range<V>> = true;
template <class V> inline constexpr bool std::ranges::enable_view<mps::row_range<V>> = true;
template <class V>
inline constexpr bool std::ranges::enable_borrowed_range<mps::row_range<V>> = true;
#endif

#endif
