// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_FIELDS_H
#define FCD_FIELDS_H

#include <layer_fcd/parameters.h> // before Qt

/// Declares the parameters of a filter to the host, with present values as defaults, or reads them, by the same calls.
class Fields {
  public:
    using Shown = host::Shown;

    /// Declares parameters. Lengths are relative to the current layer, if there is one.
    explicit Fields(const MeshDocument &document) : document(document) {}
    /// Reads parameters. \throw as the host, if \p given lacks one
    Fields(const MeshDocument &document, const RichParameterList &given) : document(document), given(&given) {}

    const RichParameterList &declared() const { return list; }
    bool areRead() const { return given; }
    bool isGiven(const QString &name) const { return given && given->hasParameter(name); }
    /// Whether there are newer parameters, which old scripts lack. \param first the first of them
    bool hasNewer(const QString &first) const { return given ? isGiven(first) : !host::firstMayBeLacking(); }
    /// From here on, parameters that are not given keep their values. (Layers always do.)
    void letLack() { mayLack = true; }

    void field(const QString &name, bool &value, Shown shown, const QString &label, const QString &help);
    void field(const QString &name, int &value, Shown shown, const QString &label, const QString &help);
    void field(const QString &name, QString &value, Shown shown, const QString &label, const QString &help);
    /// \param exponent the number is shown divided by 10^exponent
    void field(const QString &name, double &value, Shown shown, const QString &label, const QString &help,
               int exponent = 0);
    template <class Value>
    void field(const QString &name, Value &value, Shown shown, const ParameterText &text) {
        field(name, value, shown, text.label, text.help);
    }
    /// A length in units of the current layer, which the dialog also shows as a percentage of the diagonal of its box.
    void length(const QString &name, double &value, Shown shown, const QString &label, const QString &help);
    void position(const QString &name, Eigen::Vector3d &value, Shown shown, const QString &label, const QString &help);
    void direction(const QString &name, Eigen::Vector3d &value, Shown shown, const QString &label, const QString &help);
    void matrix(const QString &name, Eigen::Matrix4d &value, Shown shown, const QString &label, const QString &help);
    void openFile(const QString &name, QString &value, Shown shown, const QStringList &endings, const QString &label,
                  const QString &help);
    void saveFile(const QString &name, QString &value, Shown shown, const QString &ending, const QString &label,
                  const QString &help);

    /// One of \p values. \throw vcg::fcd::Error the value that is read is none of them
    template <class Enum>
    void choice(const QString &name, Enum &value, Shown shown, const QStringList &values, const QString &label,
                const QString &help) {
        int number = int(value);
        choice(name, number, shown, values, label, help);
        value = Enum(number);
    }
    void choice(const QString &name, int &value, Shown shown, const QStringList &values, const QString &label,
                const QString &help);
    template <class Enum>
    void choice(const QString &name, Enum &value, Shown shown, const ParameterText &text) {
        choice(name, value, shown, text.values, text.label, text.help);
    }

    /// A layer; null: there is none of that name. \param likely the default
    template <class Layer>
    void layer(const QString &name, Layer *&value, const MeshModel *likely, Shown shown, const QString &label,
               const QString &help) {
        if (!given)
            host::addLayerParameter(list, shown, name, likely, document, shared(label), shared(help));
        else if (isGiven(name))
            value = host::layerParameter(*given, name, document);
    }

    /// Reorders what was declared: \p first, then, if \p others, the rest. A handleLayer that scripts may lack begins.
    void order(QStringList first, bool others);

    const MeshDocument &document;

  private:
    /// The same text, of which there is one copy: pymeshlab keeps the parameters of each call.
    static QString shared(const QString &text);
    template <class Argument>
    static Argument shared(const Argument &other) {
        return other;
    }
    template <class Rich, class Read, class... Arguments>
    void visit(const QString &name, Shown shown, const Read &read, const Arguments &...arguments) {
        if (!given)
            host::addParameter<Rich>(list, shown, name, shared(arguments)...);
        else if (!mayLack || isGiven(name))
            read();
    }

    RichParameterList list;
    const RichParameterList *given = nullptr;
    bool mayLack = false;
};

/// The parameter that names HandleParam::likeLayer. Older scripts may lack it.
inline constexpr const char *handleLayer = "handle_layer";

#endif
