// SPDX-License-Identifier: Apache-2.0
//
// The search field of the manual. Its index is a script, since pages that are opened as files may load nothing else; it is loaded
// when the field is used first. `?q=WORDS` in a page's address begins with a search.
'use strict'

const home = document.documentElement.dataset.home
const form = document.getElementById('search')
const field = form.querySelector('input')
const found = document.getElementById('found')
const contents = document.getElementById('contents')
const most = 12
let index = null

/** As the index was made: words of letters, digits and '_'. */
const wordsOf = text => text.toLowerCase().split(/[^\p{L}\p{N}_]+/u).filter(word => word !== '')

function loadScript(name) {
  return new Promise((done, failed) => {
    const script = document.createElement('script')
    script.src = home + name
    script.onload = done
    script.onerror = () => failed(new Error(name + ' cannot be loaded'))
    document.head.append(script)
  })
}

function load() {
  index ??= loadScript('lunr.js')
    .then(() => loadScript('search_index.js'))
    .then(() => ({ ranked: lunr.Index.load(segueSearch.index), sections: segueSearch.sections }))
  return index
}

/** The sections with most of the words, the best first; the last word may be the beginning of one. */
function search({ ranked, sections }, words) {
  const hits = ranked.query(query => {
    words.forEach((word, at) => {
      query.term(lunr.tokenizer(word), { boost: 10 })
      if (at === words.length - 1) query.term(word, { usePipeline: false, wildcard: lunr.Query.wildcard.TRAILING })
    })
  })
  return hits.slice(0, most).map(hit => sections[hit.ref])
}

/** The part of the text around the first word that it has. */
function excerpt(text, words) {
  const lower = text.toLowerCase()
  const at = Math.max(0, ...words.map(word => lower.indexOf(word)))
  const from = at < 60 ? 0 : text.indexOf(' ', at - 60) + 1
  return (from > 0 ? '… ' : '') + text.slice(from, from + 160).replace(/\s\S*$/, ' …')
}

function resultOf([address, title, heading, text], words) {
  const item = document.createElement('li')
  const link = document.createElement('a')
  const name = document.createElement('b')
  const more = document.createElement('small')
  link.href = home + address
  name.textContent = title.startsWith(heading) ? title : title + ': ' + heading
  more.textContent = excerpt(text, words)
  link.append(name, more)
  item.append(link)
  return item
}

function message(text) {
  const item = document.createElement('li')
  item.textContent = text
  return item
}

async function show() {
  const words = wordsOf(field.value)
  if (words.length === 0) {
    found.hidden = true
    return
  }
  let items
  try {
    items = search(await load(), words).map(section => resultOf(section, words))
  } catch (error) {
    items = [message(error.message)]
  }
  found.replaceChildren(...(items.length > 0 ? items : [message('Nothing has these words.')]))
  found.hidden = false
}

/** Arrow keys go through the results, Escape closes them, '/' begins a search. */
function moveBetween(event) {
  const stops = [field, ...found.querySelectorAll('a')]
  const at = stops.indexOf(document.activeElement)
  const step = { ArrowDown: 1, ArrowUp: -1 }[event.key]
  if (event.key === 'Escape') found.hidden = true
  else if (event.key === '/' && at < 0) field.focus()
  else if (event.key === 'Enter' && at === 0 && stops.length > 1) stops[1].click()
  else if (step !== undefined && at >= 0) stops[Math.min(Math.max(at + step, 0), stops.length - 1)].focus()
  else return
  event.preventDefault()
}

form.hidden = false
field.addEventListener('focus', () => void load().catch(() => {}))
field.addEventListener('input', () => void show())
form.addEventListener('submit', event => event.preventDefault())
document.addEventListener('keydown', moveBetween)
document.addEventListener('click', event => {
  if (!form.contains(event.target)) found.hidden = true
})
const here = document.querySelector('nav [aria-current]')
if (here !== null) contents.scrollTop = here.offsetTop - contents.clientHeight / 2
field.value = new URLSearchParams(location.search).get('q') ?? ''
void show()
