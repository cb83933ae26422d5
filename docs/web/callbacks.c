/* The callbacks that the page gives to fmi2Instantiate: the logger is the function "log" of the page. */
#include "fmi2FunctionTypes.h"

__attribute__((import_module("page"), import_name("log"))) void page_log(fmi2Status status,
                                                                         fmi2String message);
const fmi2CallbackFunctions *page_callbacks(void);

static void logger(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                   fmi2String category, fmi2String message, ...)
{
    (void)environment;
    (void)name;
    (void)category;
    page_log(status, message);
}

const fmi2CallbackFunctions *page_callbacks(void)
{
    static const fmi2CallbackFunctions callbacks = {logger, NULL, NULL, NULL, NULL};

    return &callbacks;
}
