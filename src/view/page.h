/* page.h -- the viewer's page, in lines. */
#ifndef VIEW_PAGE_H
#define VIEW_PAGE_H

/* Each ends with NULL; lines are without their ends. */
extern const char *const page_html[], *const page_style[], *const page_script[];

#endif
