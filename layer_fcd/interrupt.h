// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_INTERRUPT_H
#define FCD_INTERRUPT_H

#include <vcg/complex/complex.h> // vcg::CallBackPos

/// Lets Ctrl-C (SIGINT) end a filter of a script, while it is there: Python only notes the signal, and looks at its
/// note when the filter is done. The handler that was there still gets it. Where none was, the signal ends the program,
/// as ever. One at a time.
class Interruptible {
  public:
    explicit Interruptible(vcg::CallBackPos *callback);
    ~Interruptible();
    Interruptible(const Interruptible &) = delete;
    Interruptible &operator=(const Interruptible &) = delete;

    /// What the host wants to be called, if anything, but false once a signal has come, too.
    vcg::CallBackPos *callback() const;

  private:
    bool isSet = false; ///< a handler that notes the signal
};

#endif
