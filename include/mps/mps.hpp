/* mps/mps.hpp - libmps for C++17 programs: handles that destroy what they own, failed calls as
 * exceptions with the library's own message, fields as arrays. Nothing else: every function is the
 * C function of its header, called through one of five templates.
 *
 *   mps::context context = mps::create_context();
 *   mps_particles_def set = mps_particles_defaults();
 *   set.spacing = 0.1;
 *   auto sand = mps::create(context, mps_particles_create, set);
 *   mps::call(sand, mps_particles_set, "density", 0, 1800.0);
 *   auto law = mps::create(context, mps_material_create_linear_elastic, 1e7, 0.3);
 *   auto solver = mps::create(context, mps_mpm_create, sand, law, def);
 *   mps::run(solver, mps_mpm_run, 1.0, 100, [](mps_mpm *s) { ... });
 *   mps_totals totals = mps::get<mps_totals>(solver, mps_mpm_get_totals);
 *   for (double vx : mps::view(sand, "velocity").column(0)) ...
 *   for (auto x : mps::view(sand, "position").rows()) std::hypot(x[0], x[1]) ...
 *
 * A C++ function, also one that throws, becomes a law, a signal or a hook by mps::bound,
 * mps::create_signal, mps::set_hook or mps::callback. A function that is given to C without it must
 * not throw: C has no way to unwind a step.
 *
 * Arguments are those of the C function, with a struct in place of a pointer to it and a handle in
 * place of its object. The context must outlive the handles that were made from it, as it does when
 * it is declared first. Thread rules are those of the C functions. Names in mps and their meaning
 * are kept through 1.x, detail excepted; binaries are not: this header is part of each program.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_MPS_HPP
#define LIBMPS_MPS_HPP

#include "mps.h"
#ifdef MPS_EXPERIMENTAL
#include "experimental.h"
#endif
#include "ranges.hpp"

#include <atomic>
#include <exception>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <type_traits>
#include <utility>

namespace mps {
inline namespace v1 {

/** A failed call: the context's error record as it was then. what() is
 *  "mps_mpm_create: cell of the solver is 0 m, must be ...". */
class error : public std::exception {
public:
  error(const mps_context *context, mps_status status) : status_(status) {
    const mps_error *last = mps_context_error(context); /* without one: that of the thread */
    if (last->status == status) record_ = *last;
    record_.status = status;
    text_ = record_.function[0] ? std::string(record_.function) + ": " : std::string();
    text_ += record_.message[0] ? record_.message : mps_status_text(status);
  }
  explicit error(mps_status status, const std::string &text) : status_(status), text_(text) {
    record_.status = status;
  }
  const char *what() const noexcept override { return text_.c_str(); }
  mps_status status() const noexcept { return status_; }
  /** Step, particle, object, where the library knew them. */
  const mps_error &record() const noexcept { return record_; }

private:
  mps_status status_;
  mps_error record_ = {MPS_OK, 0, -1, -1, {0}, {0}, {0}};
  std::string text_;
};

namespace detail {
template <class T> inline void ended(const T *) noexcept {}
inline void ended(const mps_context *context) noexcept; /* forgets its exception */
} // namespace detail

/** Owns an object of the C library, and destroys it; moves, never copies. Converts to the pointer
 *  that C functions take. A contact ends with its handle. */
template <class T> class [[nodiscard]] handle {
public:
  handle() noexcept = default;
  handle(T *object, mps_context *context) noexcept : object_(object), context_(context) {}
  handle(handle &&other) noexcept { swap(other); }
  handle &operator=(handle &&other) noexcept {
    handle gone(std::move(other));
    swap(gone);
    return *this;
  }
  ~handle() { reset(); }

  T *get() const noexcept { return object_; }
  operator T *() const noexcept { return object_; }
  /** The context with the error record of failed calls of this object. */
  mps_context *error_context() const noexcept { return context_; }
  void reset() noexcept;                                            /* destroys the object */
  T *release() noexcept { return std::exchange(object_, nullptr); } /* gives it up */
  void swap(handle &other) noexcept {
    std::swap(object_, other.object_);
    std::swap(context_, other.context_);
  }

private:
  T *object_ = nullptr;
  mps_context *context_ = nullptr;
};

#define MPS_CPP_HANDLE(name)                                                                       \
  using name = handle<mps_##name>;                                                                 \
  template <> inline void handle<mps_##name>::reset() noexcept {                                   \
    const mps_##name *object = object_;                                                            \
    mps_##name##_destroy(&object_);                                                                \
    if (object) detail::ended(object);                                                             \
  }
MPS_CPP_HANDLE(context)
MPS_CPP_HANDLE(particles)
MPS_CPP_HANDLE(kernel)
MPS_CPP_HANDLE(signal)
MPS_CPP_HANDLE(material)
MPS_CPP_HANDLE(body)
MPS_CPP_HANDLE(contact)
MPS_CPP_HANDLE(snapshot)
MPS_CPP_HANDLE(recorder)
MPS_CPP_HANDLE(history)
MPS_CPP_HANDLE(mpm)
MPS_CPP_HANDLE(dynamics)
MPS_CPP_HANDLE(elastic)
MPS_CPP_HANDLE(fluid)
#ifdef MPS_EXPERIMENTAL
MPS_CPP_HANDLE(neighbours)
MPS_CPP_HANDLE(coupling)
MPS_CPP_HANDLE(domain)
MPS_CPP_HANDLE(waves)
MPS_CPP_HANDLE(absorber)
#endif
#undef MPS_CPP_HANDLE

namespace detail {
/* Exceptions of callbacks on their way through C, the first one of each context: the callback may
 * have run on another thread than the call that it ends. */
class thrown {
public:
  static void keep(const mps_context *context) noexcept {
    const std::lock_guard<std::mutex> lock(mutex());
    try {
      if (list().emplace(context, std::current_exception()).second) count()++;
    } catch (...) { // no memory for it: the status of the call remains
    }
  }
  static bool has(const mps_context *context) noexcept {
    if (count() == 0) return false;
    const std::lock_guard<std::mutex> lock(mutex());
    return list().count(context) > 0;
  }
  static void rethrow(const mps_context *context) {
    if (const std::exception_ptr exception = take(context)) std::rethrow_exception(exception);
  }
  /** The exception of the context, or none; it is forgotten here. */
  static std::exception_ptr take(const mps_context *context) noexcept {
    if (count() == 0) return nullptr;
    const std::lock_guard<std::mutex> lock(mutex());
    const auto found = list().find(context);
    if (found == list().end()) return nullptr;
    const std::exception_ptr exception = found->second;
    list().erase(found);
    count()--;
    return exception;
  }

private:
  static std::mutex &mutex() {
    static auto *one = new std::mutex;
    return *one;
  }
  static std::map<const mps_context *, std::exception_ptr> &
  list() { /* never destroyed: a static context may end last */
    static auto *one = new std::map<const mps_context *, std::exception_ptr>;
    return *one;
  }
  static std::atomic<int> &count() {
    static std::atomic<int> one{0};
    return one;
  }
};
} // namespace detail

/** Throws what a mps::callback of the context `owner` has thrown, or mps::error where `status` is
 * not MPS_OK. */
inline void check(const mps_context *owner, mps_status status) {
  detail::thrown::rethrow(owner);
  if (status != MPS_OK) throw error(owner, status);
}

/** A C++ function as a callback of the library: `C` is its type in the headers (mps_material_fn,
 *  mps_signal_fn, mps_context_log_fn ...), `f` takes what stands behind `user` there and returns
 * the same, or nothing for MPS_OK. What it throws ends the call of the library and comes out of it,
 * if that is made by the functions of this header. The callback must live as long as what calls it,
 * which a solver may for longer than the handle of its law: mps::bound, mps::create_signal and
 * mps::set_hook give it to the library, which ends it.
 *
 *   mps::callback<mps_material_fn> update(context, [&](const mps_material_block *block) { ... });
 *   def.update = update.function();
 *   def.user = update.user(); */
template <class C> class callback;
template <class R, class... A> class callback<R (*)(void *, A...)> {
public:
  template <class F>
  callback(const mps_context *owner, F f) : body_(new typed<F>(owner, std::move(f))) {}
  auto function() const noexcept -> R (*)(void *, A...) {
    return [](void *user, A... arguments) -> R {
      return static_cast<body *>(user)->answer(arguments...);
    };
  }
  void *user() const noexcept { return body_.get(); }
  /** For the library, to which give() then leaves the function. */
  static void release(void *user) { delete static_cast<body *>(user); }
  void give() noexcept { (void)body_.release(); }

private:
  struct body {
    virtual ~body() = default;
    virtual R answer(A... arguments) noexcept = 0;
  };
  template <class F> struct typed final : body {
    typed(const mps_context *c, F &&g) : context(c), f(std::move(g)) {}
    R answer(A... arguments) noexcept override {
      if constexpr (std::is_same_v<callback<R (*)(void *, A...)>, callback<mps_context_cancel_fn>>)
        if (detail::thrown::has(context)) return 1;
      try {
        if constexpr (std::is_void_v<std::invoke_result_t<F &, A...>> && !std::is_void_v<R>) {
          f(arguments...);
          return R(0);
        } else {
          return f(arguments...);
        }
      } catch (...) {
        detail::thrown::keep(context);
      }
      if constexpr (std::is_same_v<R, mps_status>)
        return MPS_ERROR_CANCELLED;
      else if constexpr (!std::is_void_v<R>)
        return R(1); /* a cancel hook: stop */
    }
    const mps_context *context;
    F f;
  };
  std::unique_ptr<body> body_;
};

namespace detail {
inline void ended(const mps_context *context) noexcept { (void)thrown::take(context); }
} // namespace detail

/** A definition with a C++ function for its callback, which belongs to what is made from it, and to
 * this until something is: one object for each.
 *
 *   mps::bound law(context, mps_material_user_defaults());
 *   law.bind(&mps_material_user_def::update, [=](const mps_material_block *block) { ... });
 *   law.wave_modulus = 1e6;
 *   auto material = mps::create(context, mps_material_create_user, law); */
template <class D> class bound : public D {
public:
  bound(const mps_context *owner, const D &def) : D(def), owner_(owner) {}
  bound(const context &owner, const D &def) : bound(owner.get(), def) {}
  template <class C, class F> void bind(C D::*member, F f) {
    auto made = std::make_unique<callback<C>>(owner_, std::move(f));
    this->*member = made->function();
    this->user = made->user();
    this->release = callback<C>::release;
    held_ = std::unique_ptr<void, void (*)(void *)>(made->user(), callback<C>::release);
    made->give();
  }
  /** The library has it: another object needs another function. */
  void given() noexcept {
    if (!held_) return;
    (void)held_.release();
    this->user = nullptr;
    this->release = nullptr;
    given_ = true;
  }
  /** Throws where the function has been given away. */
  void usable() const {
    if (given_ && !held_)
      throw error(MPS_ERROR_STATE,
                  "mps::bound: an object has the function of this definition: bind "
                  "another one");
  }

private:
  const mps_context *owner_;
  std::unique_ptr<void, void (*)(void *)> held_{nullptr, [](void *) {}};
  bool given_ = false;
};

namespace detail {
/* What a C function takes in place of what a C++ program gives: the object of a handle, the address
 * of a struct, and everything else as it is. */
template <class T> T *pass(const handle<T> &h) { return h.get(); }
template <class T> T *pass(handle<T> &h) { return h.get(); }
template <class S> using is_struct = std::enable_if_t<std::is_class_v<std::remove_reference_t<S>>>;
template <class S, class = is_struct<S>> auto pass(S &s) -> decltype(&s) { return &s; }
template <class D> const D *pass(bound<D> &def) {
  def.usable();
  return &def;
}
template <class S, class = std::enable_if_t<!std::is_class_v<std::remove_reference_t<S>>>>
decltype(auto) pass(S &&s) {
  return std::forward<S>(s);
}

/* After a call that has succeeded. */
template <class A> void given(const A &) noexcept {}
template <class D> void given(bound<D> &def) noexcept { def.given(); }

/* T of the last parameter, T **, of a function that creates. */
template <class... P> struct last;
template <class P> struct last<P> { using type = P; };
template <class P, class... Q> struct last<P, Q...> : last<Q...> {};
template <class... P>
using created = std::remove_pointer_t<std::remove_pointer_t<typename last<P...>::type>>;
} // namespace detail

/** A context, by `def` or the defaults. Where `def` has no cancel hook, one ends the call in which
 * a hook of no answer (log, progress) threw; a mps::callback as cancel hook does that too. */
inline context create_context(const mps_context_def &def = mps_context_defaults()) {
  mps_context *made = nullptr;
  char text[512] = "";
  const mps_status status = mps_context_create(&def, &made, text, sizeof text);
  if (status != MPS_OK) throw error(status, text);
  if (!def.cancel)
    mps_context_set_cancel(
        made,
        [](void *user) -> int32_t {
          return detail::thrown::has(static_cast<const mps_context *>(user));
        },
        made, nullptr);
  return context(made, made);
}

/** Calls f(owner, arguments...). */
template <class T, class... P, class... A>
void call(const handle<T> &owner, mps_status (*f)(T *, P...), A &&...arguments) {
  check(owner.error_context(), f(owner.get(), detail::pass(arguments)...));
  (detail::given(arguments), ...);
}
template <class T, class... P, class... A>
void call(const handle<T> &owner, mps_status (*f)(const T *, P...), A &&...arguments) {
  check(owner.error_context(), f(owner.get(), detail::pass(arguments)...));
}

/** What f(owner, arguments..., &object) makes. */
template <class T, class... P, class... A>
handle<detail::created<P...>> create(const handle<T> &owner, mps_status (*f)(T *, P...),
                                     A &&...arguments) {
  detail::created<P...> *made = nullptr;
  check(owner.error_context(), f(owner.get(), detail::pass(arguments)..., &made));
  (detail::given(arguments), ...);
  return {made, owner.error_context()};
}

/** A signal of `quantity` by a C++ function f(t, motion), as mps_signal_create_user; it ends with
 *  the signal. */
template <class F> signal create_signal(const context &owner, int32_t quantity, F f) {
  callback<mps_signal_fn> motion(owner.get(), std::move(f));
  signal made = create(owner, mps_signal_create_user, quantity, motion.function(), motion.user(),
                       motion.release);
  motion.give();
  return made;
}

/** A C++ function as the log, progress or cancel hook of a context, until another one is set:
 *
 *   mps::set_hook(context, mps_context_set_log, [](int32_t level, const char *text) { ... }); */
template <class C, class F>
void set_hook(const context &owner, void (*set)(mps_context *, C, void *, mps_release_fn), F f) {
  callback<C> hook(owner.get(), std::move(f));
  set(owner.get(), hook.function(), hook.user(), hook.release);
  hook.give();
}

/** The value that f(owner, arguments..., &value) writes: a struct of results, a number. */
template <class V, class T, class... P, class... A>
V get(const handle<T> &owner, mps_status (*f)(T *, P...), A &&...arguments) {
  V value = V();
  check(owner.error_context(), f(owner.get(), detail::pass(arguments)..., &value));
  return value;
}
template <class V, class T, class... P, class... A>
V get(const handle<T> &owner, mps_status (*f)(const T *, P...), A &&...arguments) {
  V value = V();
  check(owner.error_context(), f(owner.get(), detail::pass(arguments)..., &value));
  return value;
}

/** mps_X_run(solver, t_end, every, ...) with a C++ function for the callback: `each(mps_X *)`. An
 *  exception of it ends the run and comes out of here. */
template <class T, class F>
void run(const handle<T> &solver,
         mps_status (*f)(T *, double, int64_t, mps_status (*)(void *, T *), void *), double t_end,
         int64_t every, F &&each) {
  struct caught {
    std::remove_reference_t<F> *each;
    std::exception_ptr exception;
  } state = {&each, nullptr};
  const auto callback = [](void *user, T *object) -> mps_status {
    caught *c = static_cast<caught *>(user);
    try {
      (*c->each)(object);
      return MPS_OK;
    } catch (...) {
      c->exception = std::current_exception();
      return MPS_ERROR_CANCELLED;
    }
  };
  const mps_status status = f(solver.get(), t_end, every, callback, &state);
  if (state.exception) std::rethrow_exception(state.exception);
  check(solver.error_context(), status);
}

/** A set with the same particles, independent of `set`: mps_particles_copy. */
inline particles copy(const particles &set) {
  mps_particles *made = nullptr;
  check(set.error_context(), mps_particles_copy(set.get(), &made));
  return particles(made, set.error_context());
}

/** Sets component `component` of a field (-1: all, particle by particle) from contiguous numbers,
 * as a std::vector<double> has: mps_particles_set_array. Throws MPS_ERROR_ARGUMENT where they are
 * not as many as the field has. */
template <class Values>
void set_array(const particles &set, const char *name, const Values &values,
               int32_t component = -1) {
  const auto count = mps_particles_count(set.get());
  int64_t columns = 1;
  if (component < 0) {
    mps_view view = {};
    check(set.error_context(), mps_particles_view(set.get(), name, &view));
    columns = view.shape[1];
  }
  if (static_cast<int64_t>(std::size(values)) != count * columns)
    throw error(MPS_ERROR_ARGUMENT, "values of '" + std::string(name) + "' are " +
                                        std::to_string(std::size(values)) + ", must be " +
                                        std::to_string(count * columns));
  check(set.error_context(),
        mps_particles_set_array(set.get(), name, component, std::data(values), count));
}

/** A field for reading: v(i, c) is component c of the particle at present index i. `V` is double or
 *  int64_t, as the field's. */
template <class V> class array {
public:
  array(const particles &set, const char *name) : set_(set.get()) {
    check(set.error_context(), mps_particles_view(set_, name, &view_));
    const bool integers = view_.dtype.code == 0;
    if (integers != std::is_integral_v<V> || view_.dtype.bits != 64)
      throw error(MPS_ERROR_FIELD,
                  std::string("field '") + name + "' holds " + (integers ? "int64_t" : "double"));
  }
  int64_t size() const noexcept { return view_.shape[0]; }
  int64_t components() const noexcept { return view_.shape[1]; }
  /** Particles were added, removed or sorted since: the array must be taken again. */
  bool stale() const noexcept { return mps_particles_epoch(set_) != view_.epoch; }
  const V &operator()(int64_t i, int64_t c = 0) const noexcept { return *at(i, c); }
  const V *data() const noexcept { return at(0, 0); }
  /** Component `c` (0 to components() - 1) as a range. */
  column_range<const V> column(int64_t c = 0) const noexcept {
    return {at(0, c), view_.stride[0], size()};
  }
  /** The particles, each as a row of its components: for (auto x : position.rows()) x[1] ... */
  row_range<const V> rows() const noexcept {
    return {at(0, 0), view_.stride, size(), components()};
  }
  const mps_view &raw() const noexcept { return view_; } /* strides */

protected:
  array() noexcept = default;
  const V *at(int64_t i, int64_t c) const noexcept {
    return static_cast<const V *>(view_.data) + i * view_.stride[0] + c * view_.stride[1];
  }
  mps_particles *set_ = nullptr;
  mps_view view_ = {};
};

template <class V = double> array<V> view(const particles &set, const char *name) {
  return array<V>(set, name);
}

/** A field of numbers for writing, until commit(), which throws where a value is out of range: mend
 *  it and commit again. Left without it, the values are those from before. Once committed, to write
 *  throws an error of MPS_ERROR_STATE. */
class edit : public array<double> {
public:
  edit(const particles &set, const char *name) : context_(set.error_context()), name_(name) {
    set_ = set.get();
    check(context_, mps_particles_edit(set_, name, &edit_));
    view_ = edit_.view;
  }
  edit(const edit &) = delete;
  edit &operator=(const edit &) = delete;
  ~edit() {
    if (edit_.data && mps_particles_abandon(set_, &edit_) != MPS_OK)
      mps_context_clear_error(context_);
  }
  double &operator()(int64_t i, int64_t c = 0) const {
    if (!edit_.data) throw error(MPS_ERROR_STATE, "the edit of '" + name_ + "' has been committed");
    return *mps_edit_f64(&edit_, i, c);
  }
  /** Component `c` as a range to write into; throws as operator(). */
  column_range<double> column(int64_t c = 0) const {
    return {size() > 0 ? &(*this)(0, c) : nullptr, view_.stride[0], size()};
  }
  /** The particles as rows to write into; throws as operator(). */
  row_range<double> rows() const {
    return {size() > 0 ? &(*this)(0, 0) : nullptr, view_.stride, size(), components()};
  }
  void commit() { check(context_, mps_particles_commit(set_, &edit_)); }

private:
  mps_context *context_;
  std::string name_;
  mps_edit edit_ = {};
};

} // namespace v1
} // namespace mps

#endif
