#include "my_plugin.hpp"
#include "plugin/sdk.hpp"
MPM_EXPORT_PLUGIN(material<mpm::MyPlugin>, {"my_plugin", "0.1.0", "Neo-Hookean rubber", "Ogden (1984), sec. 7.2.3",
                                            "tau = mu (b - I) + lambda/2 (J^2 - 1) I, from its energy.", "MyPlugin"})
