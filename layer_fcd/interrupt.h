// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_INTERRUPT_H
#define FCD_INTERRUPT_H

#include <vcg/complex/complex.h> // vcg::CallBackPos

/// Lets Ctrl-C (SIGINT) cancel a filter of a script while this object exists: Python only notes the signal, and looks
/// again when the filter is done. The former handler still gets the signal; without one, the signal ends the program,
/// as ever. There may be one object at a time.
class Interruptible {
  public:
    explicit Interruptible(vcg::CallBackPos *callback);
    ~Interruptible();
    Interruptible(const Interruptible &) = delete;
    Interruptible &operator=(const Interruptible &) = delete;

    /// The host's callback, if any, that also returns false once a signal has come.
    vcg::CallBackPos *callback() const;

  private:
    bool isSet = false; ///< a handler that notes the signal
};

#endif
